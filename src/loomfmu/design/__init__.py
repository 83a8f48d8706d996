"""Design functions: the physics of the FMUs, solved for a design. Uses numpy and scipy."""
