"""Tables and progress bars, on a terminal and in a notebook."""
