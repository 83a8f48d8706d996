"""The co-simulation master: steps the instances of a scene, in Python or in C, loops included."""
