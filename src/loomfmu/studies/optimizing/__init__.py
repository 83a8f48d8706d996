"""The best design of a scene within ranges and choices.

`study` reads what is wanted, `constraints` which claims must hold. `search` goes from `start`, everywhere, to
`polished`, near a good design; `runs` runs designs, each once, and keeps them; `binding` says what limits the
best. `found` writes what was found, `optimum` is the result; `best_design` and `picture` show it.
"""
