"""Questions about a scene that take many runs of it.

`limits`: how far a value may go before a claim fails; `tolerances`: the worst case of every claim within
ranges; `optimizing`: the best design within ranges and choices; `fitting`: values that measured curves imply.
`span` says what is varied and over which range, `rewritten` writes the scene with other values.
"""
