"""Limits: `limits` of one variable, `boundary` for values of a second; `search` finds roots and extremes.

`results` is what was found; `limit_tables` and `picture` show it.
"""
