"""The belt between guide and head by Hermite finite elements in space, to compare BeltDynamics with.

Another way throughout: x counts from the guide, fixed in space, through which the material moves at V; the
equation is that of the deflection w(x, t) there,

    rho (w_tt + 2 V w_xt + V^2 w_xx + A w_x) + c (w_t + V w_x) + (P w_x)_x + B (w - bow)_xxxx = 0

on elements that stretch with the free length; time by scipy's Radau.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

Motion = Callable[[float], tuple[float, float, float]]  # free length and its rates at a time


def shapes(u, size):
    """Hermite functions of an element and their first two derivatives by x; `size` is its length."""
    one = np.ones_like(u)
    value = [1 - 3 * u**2 + 2 * u**3, size * (u - 2 * u**2 + u**3), 3 * u**2 - 2 * u**3, size * (u**3 - u**2)]
    first = [-6 * u + 6 * u**2, size * (1 - 4 * u + 3 * u**2), 6 * u - 6 * u**2, size * (3 * u**2 - 2 * u)]
    second = [-6 * one + 12 * u, size * (-4 + 6 * u), 6 * one - 12 * u, size * (6 * u - 2)]
    return np.array(value).T, np.array(first).T / size, np.array(second).T / size**2


@dataclass
class FiniteElements:
    """A belt on `elements` elements; `bow(x, L)` is the curvature of its unloaded shape."""

    motion: Motion
    bow: Callable
    rho: float = 0.05
    mass: float = 0.1105
    stiffness: float = 0.25 / 0.64
    drag: float = 0.0
    tension: float = 0.0
    elements: int = 10
    bent: bool = True  # an inextensible belt that rotates; otherwise small slopes
    stands: bool = False  # the length stays as it is: the belt runs through both ends

    def __post_init__(self):
        size = 1.0 / self.elements
        nodes, weights = np.polynomial.legendre.leggauss(6)
        u = 0.5 * (nodes + 1.0)
        total = 2 * (self.elements + 1)
        points = len(u) * self.elements
        self.n, self.n1, self.n2 = (np.zeros((points, total)) for _ in range(3))
        self.x, self.w = np.zeros(points), np.zeros(points)
        for e in range(self.elements):
            rows = slice(e * len(u), (e + 1) * len(u))
            columns = slice(2 * e, 2 * e + 4)
            for matrix, part in zip((self.n, self.n1, self.n2), shapes(u, size), strict=True):
                matrix[rows, columns] = part
            self.x[rows], self.w[rows] = size * (e + u), 0.5 * size * weights
        free = [k for k in range(total) if k not in (0, total - 2)]  # w = 0 at both ends
        self.n, self.n1, self.n2 = self.n[:, free], self.n1[:, free], self.n2[:, free]
        self.inner = self.n.T @ (self.w[:, None] * self.n)
        self.inverse = np.linalg.inv(self.inner)
        self.free = len(free)

    def at(self, *terms):
        """Integral of sums of `functions.T (weight * values)` over x from 0 to 1."""
        return sum(matrix.T @ (self.w * values) for matrix, values in terms)

    def linear(self, time):
        """Matrices by which rates and values accelerate, and the load of the bow, for small slopes."""
        length, speed, a = self.motion(time)
        s, x, w = speed / length, self.x[:, None], self.w[:, None]
        weigh = lambda matrix: self.inverse @ (self.n.T @ (w * matrix)) / self.rho  # noqa: E731
        # w_tt, w_xt, w_xx, w_x at a place in space, by the rates on the stretching elements
        mesh, grows = (0.0, 0.0) if self.stands else (s, a / length)
        by_rate = self.rho * (-2 * x * mesh * self.n1 + 2 * s * self.n1) + self.drag * self.n
        by_value = self.rho * (
            (-x * grows + 2 * x * mesh**2) * self.n1 + x**2 * mesh**2 * self.n2
            - 2 * s * mesh * (self.n1 + x * self.n2) + s**2 * self.n2 + a / length * self.n1
        ) + self.drag * (s - mesh * x) * self.n1  # fmt: skip
        push = self.rho * a * length * (1 - x) + (0.0 if self.bent else self.mass * a + self.tension)
        stiff = -self.n1.T @ (w * push * self.n1) / length**2
        if not self.bent:
            stiff = stiff + self.stiffness * self.n2.T @ (w * self.n2) / length**4
        bow = self.stiffness * self.at((self.n2, self.bow(self.x * length, length))) / length**2
        return (
            -weigh(by_rate), -weigh(by_value) - self.inverse @ stiff / self.rho, self.inverse @ bow / self.rho
        )  # fmt: skip

    def rotations(self, time, d, v):
        """Accelerations by bending and push of an inextensible belt, those of `linear` given."""
        length, speed, a = self.motion(time)
        s = speed / length
        slope, bend = self.n1 @ d / length, self.n2 @ d / length**2
        cosine = np.sqrt(1.0 - slope**2)
        turning = self.n1 @ v / length - s * slope
        tilt = slope / cosine
        moment = bend / cosine**2
        twist = bend**2 * slope / cosine**4
        force = -self.stiffness * (self.at((self.n2, moment)) / length + self.at((self.n1, twist)))
        push = self.at((self.n1, tilt))  # the shortening by each value
        # second rate of the shortening L int(1 - cos), without the accelerations
        rest = (
            length * np.sum(self.w * (turning**2 / cosine**3 - tilt * (2 * s * turning + a / length * slope)))
            + 2 * speed * np.sum(self.w * tilt * turning) + a * np.sum(self.w * (1 - cosine))
        )  # fmt: skip
        return force / (self.rho * length), push / (self.rho * length), push, rest

    def accelerations(self, time, d, v):
        by_rate, by_value, bow = self.linear(time)
        found = by_rate @ v + by_value @ d + bow
        if not self.bent:
            return found
        force, lift, push, rest = self.rotations(time, d, v)
        found = found + self.inverse @ force
        lift = self.inverse @ lift
        _length, _speed, a = self.motion(time)
        load = (self.mass * (a - rest - push @ found) + self.tension) / (1.0 + self.mass * push @ lift)
        return found + load * lift

    def run(self, start, rate, times, rtol=1e-7, atol=1e-10):
        """Deflections at 201 places from guide to head, a column for each time, from shapes at the start."""
        d, v = (np.linalg.solve(self.inner, self.at((self.n, each(self.x)))) for each in (start, rate))
        n = self.free

        def jacobian(time, state):
            by_rate, by_value, _bow = FiniteElements.linear(self.small, time)
            return np.block([[np.zeros((n, n)), np.eye(n)], [by_value, by_rate]])

        self.small = FiniteElements(
            self.motion, self.bow, self.rho, self.mass, self.stiffness, self.drag, self.tension,
            self.elements, False,
        )  # fmt: skip
        found = solve_ivp(
            lambda t, y: np.concatenate([y[n:], self.accelerations(t, y[:n], y[n:])]),
            (times[0], times[-1]), np.concatenate([d, v]), method="Radau", t_eval=times, rtol=rtol, atol=atol,
            jac=jacobian,
        )  # fmt: skip
        return self.places(201) @ found.y[:n]

    def places(self, count):
        """Matrix of the values at equally spaced places."""
        size, total = 1.0 / self.elements, 2 * (self.elements + 1)
        rows = np.zeros((count, total))
        for k, x in enumerate(np.linspace(0.0, 1.0, count)):
            e = min(int(x / size), self.elements - 1)
            rows[k, 2 * e : 2 * e + 4] = shapes(np.array([x / size - e]), size)[0][0]
        return np.delete(rows, [0, total - 2], axis=1)
