"""Questions about a scene that take many runs of it: how far a value may go before a claim fails (`limits`).

`span` says what is varied and over which range, `search` finds roots and extremes of a claim's distance to
its bound, `boundary` repeats that for values of a second variable; `report` and `pictures` show the results.
"""
