"""Fits: `measured` reads curves and shifts them, `curves` holds a run against them, `search` finds the
parameters under one of its losses, `intervals` says how sure they are, by what remains.

`fit` is the public face; `fitted_values` shows what was found.
"""
