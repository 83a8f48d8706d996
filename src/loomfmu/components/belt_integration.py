"""How BeltDynamics integrates its modes: a step of Gauss's method, and its work."""

from dataclasses import dataclass
from math import fabs, pi

from ..physics.belt_modes import same, size, summed
from ..physics.belt_motion import energy_and_powers
from ..physics.numerics.gauss import (
    FIRST,
    GAUSS_11,
    GAUSS_12,
    GAUSS_13,
    GAUSS_21,
    GAUSS_22,
    GAUSS_23,
    GAUSS_31,
    GAUSS_32,
    GAUSS_33,
    INNER,
    LAST,
    OUTER,
    PLACE_A,
    PLACE_B,
    PLACE_C,
    SQUARE_11,
    SQUARE_12,
    SQUARE_13,
    SQUARE_21,
    SQUARE_22,
    SQUARE_23,
    SQUARE_31,
    SQUARE_32,
    SQUARE_33,
    corrected,
    stage,
)
from .belt_path import BeltPath

MOST_REPEATS = 30  # of the sweep over the stages, until the accelerations of an integration step are settled
SETTLED = 1e-12  # of the modes: what a sweep may still change


@dataclass(slots=True)
class BeltIntegration(BeltPath):
    """A step of the belt's modes by Gauss's method of order 6, whose stages are found by repetition."""

    def sums(self) -> None:
        """Sizes of the modes and of their rates."""
        self.mode_sum = size(*self.mode)
        self.rate_sum = size(*self.mode_rate)

    def try_modes(self) -> None:
        """Make the modes the trial place."""
        self.trial = same(*self.mode)
        self.trial_rate = same(*self.mode_rate)

    def advance(self, share: float, taken: float) -> bool:
        """One step of Gauss's method from a share of the step; whether its accelerations settled."""
        self.sweeps = self.sweeps + 1
        duration = taken * self.path_step
        low = 0.5 * self.shortest_length
        near = self.length_at(share + FIRST * taken) > low and self.length_at(share + 0.5 * taken) > low
        if not (near and self.length_at(share + LAST * taken) > low and self.length_at(share + taken) > low):
            return False
        self.try_modes()
        self.gauss_b = self.rates_at(share)
        self.gauss_a = same(*self.gauss_b)
        self.gauss_c = same(*self.gauss_b)
        self.sums()
        settled = SETTLED * (self.mode_sum + duration * self.rate_sum) + 1e-30
        before = 1e300
        change = 1e300
        for repeat in range(MOST_REPEATS):
            self.sweeps = self.sweeps + 1
            self.visit_first(duration)
            self.found_a = self.rates_at(share + FIRST * taken)
            self.visit_second(duration)
            self.found_b = self.rates_at(share + 0.5 * taken)
            self.visit_third(duration)
            self.found_c = self.rates_at(share + LAST * taken)
            change = self.correct(share + 0.5 * taken, duration)
            if change <= settled or not change < 1e200:
                break
            if repeat > 4 and change > 0.8 * before:
                break
            before = change
        if not change <= settled:
            return False
        self.account(share, taken, duration)
        self.visit_end(duration)
        return True

    def visit(
        self, duration: float, share: float,
        place_a: float, place_b: float, place_c: float, rate_a: float, rate_b: float, rate_c: float,
    ) -> None:  # fmt: skip
        """Make the modes at a share of the integration step the trial place, by the weights of its stages."""
        square = duration * duration
        self.trial = stage(
            duration * share, square * place_a, square * place_b, square * place_c,
            *self.mode, *self.mode_rate, *self.gauss_a, *self.gauss_b, *self.gauss_c,
        )  # fmt: skip
        self.trial_rate = stage(
            0.0, duration * rate_a, duration * rate_b, duration * rate_c,
            *self.mode_rate, *self.mode_rate, *self.gauss_a, *self.gauss_b, *self.gauss_c,
        )  # fmt: skip

    def visit_first(self, duration: float) -> None:
        """Make the modes at the first stage the trial place."""
        self.visit(duration, FIRST, SQUARE_11, SQUARE_12, SQUARE_13, GAUSS_11, GAUSS_12, GAUSS_13)

    def visit_second(self, duration: float) -> None:
        """Make the modes at the second stage the trial place."""
        self.visit(duration, 0.5, SQUARE_21, SQUARE_22, SQUARE_23, GAUSS_21, GAUSS_22, GAUSS_23)

    def visit_third(self, duration: float) -> None:
        """Make the modes at the third stage the trial place."""
        self.visit(duration, LAST, SQUARE_31, SQUARE_32, SQUARE_33, GAUSS_31, GAUSS_32, GAUSS_33)

    def visit_end(self, duration: float) -> None:
        """Make the modes at the end of the integration step the trial place."""
        self.visit(duration, 1.0, PLACE_A, PLACE_B, PLACE_C, OUTER, INNER, OUTER)

    def go_on(self) -> None:
        """Make the trial place the present one, and count the work up to there."""
        self.mode = same(*self.trial)
        self.mode_rate = same(*self.trial_rate)
        self.push_work = self.push_work + self.step_push
        self.guide_work = self.guide_work + self.step_guide
        self.lost_work = self.lost_work + self.step_loss
        self.energy_through = self.energy_through + self.step_through

    def correct(self, share: float, duration: float) -> float:
        """Correct the accelerations of all stages for what was found; how far that moves the modes."""
        length = self.length_at(share)
        pushed = self.pushed_at(share)
        square = duration * duration
        a1, a2, a3, a4, a5, a6 = summed(-1.0, *self.gauss_a, *self.found_a)
        b1, b2, b3, b4, b5, b6 = summed(-1.0, *self.gauss_b, *self.found_b)
        c1, c2, c3, c4, c5, c6 = summed(-1.0, *self.gauss_c, *self.found_c)
        a1, b1, c1 = corrected(square * self.stiff(1, length, pushed), a1, b1, c1)
        a2, b2, c2 = corrected(square * self.stiff(2, length, pushed), a2, b2, c2)
        a3, b3, c3 = corrected(square * self.stiff(3, length, pushed), a3, b3, c3)
        a4, b4, c4 = corrected(square * self.stiff(4, length, pushed), a4, b4, c4)
        a5, b5, c5 = corrected(square * self.stiff(5, length, pushed), a5, b5, c5)
        a6, b6, c6 = corrected(square * self.stiff(6, length, pushed), a6, b6, c6)
        self.gauss_a = summed(1.0, a1, a2, a3, a4, a5, a6, *self.gauss_a)
        self.gauss_b = summed(1.0, b1, b2, b3, b4, b5, b6, *self.gauss_b)
        self.gauss_c = summed(1.0, c1, c2, c3, c4, c5, c6, *self.gauss_c)
        largest = size(a1, a2, a3, a4, a5, a6) + size(b1, b2, b3, b4, b5, b6)
        return square * (largest + size(c1, c2, c3, c4, c5, c6))

    def stiff(self, number: int, length: float, pushed: float) -> float:
        """Square of the frequency of a mode, 0 for one that grows."""
        wave = number * pi / length
        stiff = wave * wave * (self.stiffness * wave * wave - pushed) / self.belt_mass
        return stiff if stiff > 0.0 else 0.0

    def account(self, share: float, taken: float, duration: float) -> None:
        """Add up the work of an integration step by Gauss's quadrature at its stages."""
        self.step_push = 0.0
        self.step_guide = 0.0
        self.step_loss = 0.0
        self.step_through = 0.0
        self.visit_first(duration)
        self.found_a = self.rates_at(share + FIRST * taken)
        self.work(share + FIRST * taken, OUTER * duration, *self.found_a)
        self.visit_second(duration)
        self.found_b = self.rates_at(share + 0.5 * taken)
        self.work(share + 0.5 * taken, INNER * duration, *self.found_b)
        self.visit_third(duration)
        self.found_c = self.rates_at(share + LAST * taken)
        self.work(share + LAST * taken, OUTER * duration, *self.found_c)

    def work(
        self, share: float, time: float, a1: float, a2: float, a3: float, a4: float, a5: float, a6: float
    ) -> None:
        """Add the work of all powers at a stage over a time."""
        _energy, push, guide, loss = energy_and_powers(  # type: ignore[call-arg]
            *self.trial,  # type: ignore[arg-type]
            *self.trial_rate, a1, a2, a3, a4, a5, a6, self.length_at(share),
            self.velocity_at(share), self.acceleration_at(share), self.tension_at(share), self.head_mass,
            self.belt_mass, 2.0 * self.belt_mass * self.damping, self.stiffness, self.bow_of, self.bow,
            self.bow_length, self.compression,
        )  # fmt: skip
        self.step_push = self.step_push + time * push
        self.step_guide = self.step_guide + time * guide
        self.step_loss = self.step_loss + time * loss
        self.step_through = self.step_through + time * (fabs(push) + fabs(guide) + fabs(loss))

    def energy_at(self, share: float) -> float:
        """Energy of the trial place at a share of the step."""
        energy, _push, _guide, _loss = energy_and_powers(  # type: ignore[call-arg]
            *self.trial,  # type: ignore[arg-type]
            *self.trial_rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, self.length_at(share),
            self.velocity_at(share), self.acceleration_at(share), self.tension_at(share), self.head_mass,
            self.belt_mass, 2.0 * self.belt_mass * self.damping, self.stiffness, self.bow_of, self.bow,
            self.bow_length, 0.0,
        )  # fmt: skip
        return energy
