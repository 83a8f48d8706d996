"""The description in an FMU: model description, terminals, documentation, parameter sets."""
