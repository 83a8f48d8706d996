"""The best design of a scene within ranges and choices.

`study` reads what is wanted. `search` goes from `start`, everywhere, to designs `near` a good one;
`runs` runs designs, each once, and keeps them; `binding` says what limits the best. `optimize` is the public
face, and writes what was found; `optimum` is the result, which `best_design` shows.
"""
