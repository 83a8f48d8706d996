"""Numbers and types of the variables in a model description."""

FMI_TYPES = {float: "Real", int: "Integer", bool: "Boolean"}
FIRST_REFERENCE = 1  # not 0: then a value reference is a variable's place too, for which OMSimulator takes it
