"""A belt on a race board by Hermite finite elements: at rest with rigid one-sided stops, or in motion.

Another way than that of BeltDynamics: small slopes, cubic elements with stops at all nodes, whose forces
solve a linear complementarity problem, by non-negative least squares.
"""

from dataclasses import dataclass

import numpy as np
from belt_reference import FiniteElements
from scipy.optimize import nnls


def on_board(belt, length, compression, side, distance, touches=0):
    """Largest deflection of a belt that stands on a board [m], and how many nodes touch it.

    The board is on the side 1 of the bow, or -1; `touches` is 1 if the guide clamps the belt.
    """
    bending, squeezed = belt.matrices(length)
    keep = np.arange(belt.free)[touches:]  # the first is the slope at the guide
    stiff = (bending - compression * squeezed)[np.ix_(keep, keep)]
    weight = belt.rho * belt.gravity * belt.at((belt.n, np.ones_like(belt.x)))
    free = np.linalg.solve(stiff, (belt.bow_load(length) + weight)[keep])
    at_nodes = belt.places(belt.elements + 1)[1:-1][:, keep]
    chord = belt.offset * np.linspace(1.0, 0.0, belt.elements + 1)[1:-1]
    # room + flexibility @ force >= 0, force >= 0, one of them 0 at each node
    room = distance - side * (at_nodes @ free + chord)
    flexibility = at_nodes @ np.linalg.solve(stiff, at_nodes.T)
    root = np.linalg.cholesky(0.5 * (flexibility + flexibility.T)).T
    force, _rest = nnls(root, -np.linalg.solve(root.T, room), maxiter=100 * len(room))
    held = free - side * np.linalg.solve(stiff, at_nodes.T @ force)
    return np.abs(belt.places(401)[:, keep] @ held).max(), (force > 0.0).sum()


@dataclass
class MovingOnBoard(FiniteElements):
    """A belt in motion on a board whose cover has a stiffness for each length of belt."""

    side: float = 1.0
    distance: float = 0.0
    cover: float = 1e7

    def pressed(self, d):
        """How far each place is pressed into the cover."""
        return np.maximum(0.0, self.side * (self.n @ d) - self.distance)

    def rotations(self, time, d, v):
        force, *rest = super().rotations(time, d, v)
        return force - self.at((self.n, self.cover * self.side * self.pressed(d))) / self.rho, *rest

    def jacobian(self, time, state, side):
        found, n = super().jacobian(time, state, side), self.free
        weights = self.w * self.cover * (self.pressed(state[:n]) > 0.0)
        found[n:, :n] -= self.inverse @ (self.n.T @ (weights[:, None] * self.n)) / self.rho
        return found
