"""Fits: `measured` reads curves, `curves` holds a run against them, `fit` finds the parameters.

`report`, `picture` and `command` show what was found.
"""
