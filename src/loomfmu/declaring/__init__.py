"""Declaring a component: its variables, and what follows from them."""
