"""Tolerances: the worst case of every claim within them; `report` and `command` show it."""
