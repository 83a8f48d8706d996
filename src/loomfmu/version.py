"""The version of this package, which also stands in every FMU and every trace that it writes."""

__version__ = "0.1.0"
