"""What people read: tables and progress bars, on a terminal and in a notebook."""
