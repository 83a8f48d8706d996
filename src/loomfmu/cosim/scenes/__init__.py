"""Scenes: what is simulated, read from text, checked, and wired."""
