"""Native FMUs: components translated to C, compiled with one shell for all."""
