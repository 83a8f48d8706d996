"""A trace as a page to look at: one HTML file that needs nothing else, and no network."""

from .document import REPORT, write
from .templates import check

__all__ = ["REPORT", "check", "write"]
