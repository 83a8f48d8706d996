"""The mechanisms of the loom as schematic drawings that move with the page's cursor."""

from .section import sections

__all__ = ["sections"]
