"""The validation report: what the sources publish beside what the components compute.

Each source has a module of pure functions that return sections; `report` assembles them, `plots` draws.
"""
