"""The names that the file of a claim of your own imports."""

from .cosim.claims.arguments import Angles, Flag, Name, Names, Quantity, argument
from .cosim.claims.own_claims import OwnClaim
from .traces import Signals

__all__ = ["Angles", "Flag", "Name", "Names", "OwnClaim", "Quantity", "Signals", "argument"]
