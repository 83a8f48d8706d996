"""A belt that is pushed along a race board, by its own finite elements and integration: a second reference.

Another way than that of BeltDynamics and of `belt_reference`: Hermite elements on the belt itself, between
head and guide, which stretch as it grows, with x = X / L from the head,

    u_t = U_t - x a U_x,   u_tt = U_tt - 2 x a U_xt + x^2 a^2 U_xx + x (2 a^2 - A / L) U_x,   a = V / L

for small slopes and a head that does not lag. The board is rigid, one-sided at all nodes, by a
complementarity problem at each step that a primal-dual active set solves; or it has the cover of
BeltDynamics. Time goes in equal steps by Newmark's method: the trapezoidal rule or, on the rigid board, with
damping of what the steps do not resolve.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from belt_reference import shapes

MOST = 50  # changes of what touches in a step


@dataclass
class PushedBelt:
    """A belt with pinned ends behind a head of a given motion: free length and its rates at a time."""

    motion: Callable
    bow: Callable  # curvature of the unloaded belt at a distance from the head, and a free length
    mass: float
    head_mass: float
    stiffness: float
    gravity: float
    side: float  # of the board, 1 or -1; 0 without
    distance: float
    cover: float = 0.0  # its stiffness; 0: rigid
    elements: int = 16
    touching: np.ndarray = field(init=False)

    def __post_init__(self):
        size, total = 1.0 / self.elements, 2 * (self.elements + 1)
        nodes, weights = np.polynomial.legendre.leggauss(5)
        u = 0.5 * (nodes + 1.0)
        self.x = np.concatenate([size * (e + u) for e in range(self.elements)])
        self.w = np.tile(0.5 * size * weights, self.elements)
        self.n, self.n1, self.n2 = (np.zeros((len(self.x), total)) for _ in range(3))
        for e in range(self.elements):
            rows, columns = slice(e * len(u), (e + 1) * len(u)), slice(2 * e, 2 * e + 4)
            for matrix, part in zip((self.n, self.n1, self.n2), shapes(u, size), strict=True):
                matrix[rows, columns] = part
        ends = [0, total - 2]
        self.n, self.n1, self.n2 = (np.delete(each, ends, axis=1) for each in (self.n, self.n1, self.n2))
        free = [n for n in range(total) if n not in ends]
        self.nodes = [free.index(2 * e) for e in range(1, self.elements)]
        over = lambda left, right, by=1.0: left.T @ ((self.w * by)[:, None] * right)  # noqa: E731
        self.inertia, self.squeezed = over(self.n, self.n), over(self.n1, self.n1)
        self.squeezed_along, self.bending = over(self.n1, self.n1, self.x), over(self.n2, self.n2)
        self.carried, self.carried_twice = over(self.n, self.n1, self.x), over(self.n, self.n2, self.x**2)
        self.touching = np.zeros(len(self.nodes), bool)

    def forces(self, time):
        """By rates and by values, and what else acts, at a time; of mass M = mass L `inertia`."""
        length, speed, growth = self.motion(time)
        a = speed / length
        by_rate = -2.0 * self.mass * speed * self.carried
        by_value = (
            self.mass * length * (a * a * self.carried_twice + (2.0 * a * a - growth / length) * self.carried)
            - (self.head_mass * growth * self.squeezed) / length
            - self.mass * growth * self.squeezed_along
            + self.stiffness / length**3 * self.bending
        )
        load = self.stiffness / length * self.n2.T @ (self.w * self.bow(self.x * length, length))
        load = load + self.mass * self.gravity * length * self.n.T @ self.w
        return self.mass * length * self.inertia, by_rate, by_value, load

    def solved(self, matrix, known, length):
        """Solution of `matrix q = known` with the board's reaction."""
        if self.side == 0.0:
            return np.linalg.solve(matrix, known)
        if self.cover:
            return self.on_cover(matrix, known, length)
        stop = self.side * self.distance
        for _ in range(MOST):
            held = [node for node, on in zip(self.nodes, self.touching, strict=True) if on]
            free = np.setdiff1d(np.arange(len(known)), held)
            found = np.full(len(known), stop)
            right = known[free] - matrix[np.ix_(free, held)].sum(axis=1) * stop
            found[free] = np.linalg.solve(matrix[np.ix_(free, free)], right)
            push = self.side * (known - matrix @ found)[self.nodes]
            beyond = self.side * found[self.nodes] - self.distance
            touching = np.where(self.touching, push > 0.0, beyond > 0.0)
            if (touching == self.touching).all():
                return found
            self.touching = touching
        raise AssertionError("what touches the board does not settle")

    def on_cover(self, matrix, known, length):
        """As `solved`, where the cover pushes back."""
        pressed = None
        found = np.linalg.solve(matrix, known)
        for _ in range(MOST):
            deep = self.side * (self.n @ found) > self.distance
            if pressed is not None and (deep == pressed).all():
                return found
            pressed = deep
            weights = self.cover * length * self.w * deep
            stop = self.n.T @ (weights * self.side * self.distance)
            found = np.linalg.solve(matrix + self.n.T @ (weights[:, None] * self.n), known + stop)
        raise AssertionError("what is pressed into the cover does not settle")

    def still(self, time):
        """Values of a belt in equilibrium at a time, as if its length stood still."""
        length = self.motion(time)[0]
        _mass, _by_rate, by_value, load = self.forces(time)
        return self.solved(by_value, load, length)

    def run(self, start, end, step):
        """Times and deflections at all places, from equilibrium on."""
        q = self.still(start)
        v = (self.still(start + step) - q) / step
        share = 0.5 if self.cover or self.side == 0.0 else 0.6  # of the new rate: above a half it damps
        by_q = 1.0 / (0.25 * (share + 0.5) ** 2 * step * step)
        by_v = share * step * by_q
        a = np.zeros_like(q)
        times, found = [start], [self.n @ q]
        for n in range(round((end - start) / step)):
            time = start + (n + 1) * step
            mass, by_rate, by_value, load = self.forces(time)
            ahead = q + step * v + (0.5 * step * step - 1.0 / by_q) * a
            ahead_rate = v + step * (1.0 - share) * a
            known = load + by_q * (mass @ ahead) - by_rate @ (ahead_rate - by_v * ahead)
            q = self.solved(by_q * mass + by_v * by_rate + by_value, known, self.motion(time)[0])
            a = by_q * (q - ahead)
            v = ahead_rate + share * step * a
            times.append(time)
            found.append(self.n @ q)
        return np.array(times), np.array(found)
