"""Fits: `measured` reads curves, `curves` holds a run against them, `offset` shifts them, `search` finds the
parameters under one of the `losses`, `intervals` says how sure they are, by `independence` of what remains.

`fit` is the public face; `fitted_values` shows what was found.
"""
