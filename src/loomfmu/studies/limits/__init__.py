"""Limits: `limits` of one variable, and for values of a second; `search` finds roots and extremes.

`results` is what was found; `limit_tables` shows it.
"""
