"""Co-simulation of FMUs over main-shaft time: knows FMUs, and no physics."""
