"""The belt between guide and head by Hermite finite elements in space, to compare BeltDynamics with.

Another way throughout: x counts from the guide, fixed in space, through which the material moves at V; the
equation is that of the deflection w(x, t) there,

    rho (w_tt + 2 V w_xt + V^2 w_xx + A w_x) + c (w_t + V w_x) + (P w_x)_x + B (w - bow)_xxxx = 0

on elements that stretch with the free length; time by scipy's Radau.

A guided head has no slope of its own. The guide is rigid: from event to event the belt's end in it either
turns freely, or as the guide lets it. What the element at the guide loses of its motion when it is stopped
falls with the cube of its size. With `offset` the chord turns as the belt grows: w is the deflection from it,
and w + offset (1 - x / L) moves by the equation above.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.integrate import solve_ivp

RATES = 1e4  # 1/s, a slow bow's: by this, rates may be off by more than deflections
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
    guided: bool = False  # the head cannot turn
    clearance: float | None = None  # between belt and guide; None: the belt turns freely
    guide: float = 0.05  # length over which the guide holds the belt
    gravity: float = 0.0  # to the side of the bow
    offset: float = 0.0  # of the guide's exit from the head's line, for the inertia of a growing chord

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
        self.held = [0, total - 2] + [total - 1] * self.guided  # w = 0 at both ends
        self.n, self.n1, self.n2 = (np.delete(each, self.held, axis=1) for each in (self.n, self.n1, self.n2))
        self.inner = self.n.T @ (self.w[:, None] * self.n)
        self.inverse = np.linalg.inv(self.inner)
        self.free = total - len(self.held)

    def at(self, *terms):
        """Integral of sums of `functions.T (weight * values)` over x from 0 to 1."""
        return sum(matrix.T @ (self.w * values) for matrix, values in terms)

    def linear(self, time):
        """Matrices by which rates and values accelerate, and what else does, for small slopes."""
        length, speed, a = self.motion(time)
        s, x, w = speed / length, self.x[:, None], self.w[:, None]
        weigh = lambda matrix: self.inverse @ (self.n.T @ (w * matrix)) / self.rho  # noqa: E731
        # w_tt, w_xt, w_xx, w_x at a place in space, by the rates on the stretching elements
        mesh, grows = (0.0, 0.0) if self.stands else (s, a / length)
        by_rate = self.rho * (-2 * x * mesh * self.n1 + 2 * s * self.n1) + self.drag * self.n
        by_value = (
            self.rho
            * (
                (-x * grows + 2 * x * mesh**2) * self.n1
                + x**2 * mesh**2 * self.n2
                - 2 * s * mesh * (self.n1 + x * self.n2)
                + s**2 * self.n2
                + a / length * self.n1
            )
            + self.drag * (s - mesh * x) * self.n1
        )
        push = self.rho * a * length * (1 - x) + (0.0 if self.bent else self.mass * a + self.tension)
        stiff = -self.n1.T @ (w * push * self.n1) / length**2
        if not self.bent:
            stiff = stiff + self.stiffness * self.n2.T @ (w * self.n2) / length**4
        turning = 2.0 * s**2 * (1 - self.x) + a / length * self.x - self.drag / self.rho * s * (1 - self.x)
        load = self.bow_load(length)
        load = load + self.rho * self.at((self.n, self.gravity - self.offset * turning))
        stiff, load = self.inverse @ stiff / self.rho, self.inverse @ load / self.rho
        return -weigh(by_rate), -weigh(by_value) - stiff, load

    def bow_load(self, length):
        return self.stiffness * self.at((self.n2, self.bow(self.x * length, length))) / length**2

    def stopped(self, time, side):
        """Slope of the end in the guide that touches it on a side, times L, and its rates."""
        length, speed, a = self.motion(time)
        c = side * self.clearance
        return c * (length / self.guide + 0.5), c * speed / self.guide, c * a / self.guide

    def touched(self, time, slope):
        """Side on which the end in the guide touches it, if its slope, times L, is at the stop or beyond."""
        if self.clearance is None or abs(slope) < self.stopped(time, 1.0)[0] * (1.0 - 1e-9):
            return 0.0
        return math.copysign(1.0, slope)

    def matrices(self, length):
        """Of bending and of a compression of 1 N, over the length, for small slopes."""
        bending = self.stiffness / length**4 * self.n2.T @ (self.w[:, None] * self.n2)
        return bending, self.n1.T @ (self.w[:, None] * self.n1) / length**2

    def equilibrium(self, time, side=0.0, compression=0.0):
        """Nodes of a belt at rest that touches its guide on a side or not at all (0), for small slopes."""
        length = self.motion(time)[0]
        bending, squeezed = self.matrices(length)
        stiff, found = bending - compression * squeezed, self.bow_load(length)
        if side == 0.0:
            return np.linalg.solve(stiff, found)
        slope = self.stopped(time, side)[0]
        found[1:] = np.linalg.solve(stiff[1:, 1:], found[1:] - stiff[1:, 0] * slope)
        found[0] = slope
        return found

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
            + 2 * speed * np.sum(self.w * tilt * turning)
            + a * np.sum(self.w * (1 - cosine))
        )
        return force / (self.rho * length), push / (self.rho * length), push, rest

    def accelerations(self, time, d, v, side=0.0):
        """Of the nodes, and what the guide adds to that of the slope in it."""
        by_rate, by_value, load = self.linear(time)
        free, lift, push, rest = by_rate @ v + by_value @ d + load, *np.zeros((2, self.free)), 0.0
        if self.bent:
            force, lift, push, rest = self.rotations(time, d, v)
            free, lift = free + self.inverse @ force, self.inverse @ lift
        held, lifted = free, lift
        if side != 0.0:
            held = free + self.turned * (self.stopped(time, side)[2] - free[0])
            lifted = lift - self.turned * lift[0]
        _length, _speed, a = self.motion(time)
        load = (self.mass * (a - rest - push @ held) + self.tension) / (1.0 + self.mass * push @ lifted)
        return held + load * lifted, held[0] - free[0] - load * lift[0]

    @property
    def turned(self):
        """What a moment at the guide does to the nodes, over what it does to the slope there."""
        return self.inverse[:, 0] / self.inverse[0, 0]

    @cached_property
    def small(self):
        """The same belt with small slopes."""
        return replace(self, bent=False)

    def jacobian(self, time, _state, side):
        """By nodes and their rates; a belt that rotates is close enough to one with small slopes."""
        n = self.free
        by_rate, by_value, _load = self.small.linear(time)
        if side != 0.0:
            by_rate, by_value = (each - np.outer(self.turned, each[0]) for each in (by_rate, by_value))
        return np.block([[np.zeros((n, n)), np.eye(n)], [by_value, by_rate]])

    def run(self, start, rate, times, rtol=1e-7, atol=1e-10):
        """Deflections at 201 places from guide to head, a column for each time, from shapes at the start."""
        d, v = (np.linalg.solve(self.inner, self.at((self.n, each(self.x)))) for each in (start, rate))
        return self.places(201) @ self.nodes(d, v, times, rtol, atol)

    def nodes(self, d, v, times, rtol=1e-7, atol=1e-10):
        """Those of the belt, a column for each time, from those at the start and their rates."""
        times, n, columns, time = np.asarray(times), self.free, np.empty((self.free, 0)), times[0]
        side, d, v = self.met(time, d, v)
        while True:
            found = solve_ivp(
                lambda t, y, side: np.concatenate([y[n:], self.accelerations(t, y[:n], y[n:], side)[0]]),
                (time, times[-1]),
                np.concatenate([d, v]),
                method="Radau",
                t_eval=times[columns.shape[1] :],
                rtol=rtol,
                atol=atol * np.repeat([1.0, RATES], n),
                jac=self.jacobian,
                args=(side,),
                events=self.released if side else self.reached,
            )
            if len(found.t):
                columns = np.hstack([columns, found.y[:n]])
            if found.status == 0:
                return columns
            time = found.t_events[0][-1]
            d, v = np.split(found.y_events[0][-1], 2)
            side, d, v = (0.0, self.inside(d), v) if side else self.met(time, d, v)

    def met(self, time, d, v):
        """Side on which the guide holds the belt's end, and nodes and rates as it stops them."""
        side = self.touched(time, d[0])
        if side != 0.0:
            beyond = v[0] - self.stopped(time, side)[1]
            v = v - self.turned * (beyond if side * beyond > 0.0 else 0.0)
            if self.released(time, np.concatenate([d, v]), side) > 0.0:
                return 0.0, self.inside(d), v
        return side, d, v

    @staticmethod
    def inside(d):
        """Nodes of a belt that leaves its stop, so little away from it that a return is noticed."""
        return np.append(d[0] * (1.0 - 1e-9), d[1:])

    def reached(self, time, state, _side):
        """Above 0 where the end is beyond its stop."""
        return -1.0 if self.clearance is None else abs(state[0]) - self.stopped(time, 1.0)[0]

    def released(self, time, state, side):
        """Above 0 where the guide would have to hold the end back, which one without clearance does."""
        if self.clearance == 0.0:
            return -1.0
        return side * self.accelerations(time, state[: self.free], state[self.free :], side)[1]

    reached.terminal = released.terminal = True
    reached.direction = released.direction = 1.0

    def places(self, count):
        """Matrix of the values at equally spaced places."""
        size, total = 1.0 / self.elements, 2 * (self.elements + 1)
        rows = np.zeros((count, total))
        for k, x in enumerate(np.linspace(0.0, 1.0, count)):
            e = min(int(x / size), self.elements - 1)
            rows[k, 2 * e : 2 * e + 4] = shapes(np.array([x / size - e]), size)[0][0]
        return np.delete(rows, self.held, axis=1)
