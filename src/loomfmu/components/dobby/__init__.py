"""The dobby drive: its law's parameters, the laws, the FMU."""
