"""A system of components as one native FMU: wired inside, stepped from sources to sinks."""
