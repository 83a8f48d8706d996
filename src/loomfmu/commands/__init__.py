"""What the commands of `loomfmu` do: a function for each, which returns the exit status."""
