"""The plan of a run: the requested signals, the FMUs that can be left out, and the steps."""
