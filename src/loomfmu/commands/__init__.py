"""The commands of `loomfmu`: a function for each, which returns the exit status."""
