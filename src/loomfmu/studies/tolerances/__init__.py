"""Tolerances: the worst case of every claim within them; `worst_cases` shows it."""
