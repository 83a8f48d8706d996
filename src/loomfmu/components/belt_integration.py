"""How BeltDynamics integrates its modes: a step of Gauss's method, and its work."""

from dataclasses import dataclass
from math import fabs, pi

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
)
from .belt_path import BeltPath

MOST_SWEEPS = 30  # until the accelerations of an integration step are settled
SETTLED = 1e-13  # of the modes: what a sweep may still change


@dataclass(slots=True)
class BeltIntegration(BeltPath):
    """A step of the belt's modes by Gauss's method of order 6, whose stages are found by repetition."""

    def sums(self) -> None:
        """Sizes of the modes and of their rates."""
        self.mode_sum = (
            fabs(self.mode[0]) + fabs(self.mode[1]) + fabs(self.mode[2])
            + fabs(self.mode[3]) + fabs(self.mode[4]) + fabs(self.mode[5])
        )  # fmt: skip
        self.rate_sum = (
            fabs(self.mode_rate[0]) + fabs(self.mode_rate[1]) + fabs(self.mode_rate[2])
            + fabs(self.mode_rate[3]) + fabs(self.mode_rate[4]) + fabs(self.mode_rate[5])
        )  # fmt: skip

    def try_modes(self) -> None:
        """Make the modes the trial place."""
        self.trial = (self.mode[0], self.mode[1], self.mode[2], self.mode[3], self.mode[4], self.mode[5])
        self.trial_rate = (
            self.mode_rate[0],
            self.mode_rate[1],
            self.mode_rate[2],
            self.mode_rate[3],
            self.mode_rate[4],
            self.mode_rate[5],
        )

    def advance(self, share: float, taken: float) -> bool:
        """One step of Gauss's method from a share of the step; whether its accelerations settled."""
        duration = taken * self.path_step
        low = 0.5 * self.shortest_length
        near = self.length_at(share + FIRST * taken) > low and self.length_at(share + 0.5 * taken) > low
        if not (near and self.length_at(share + LAST * taken) > low and self.length_at(share + taken) > low):
            return False
        self.try_modes()
        self.gauss_b = self.rates_at(share)
        self.gauss_a = (
            self.gauss_b[0],
            self.gauss_b[1],
            self.gauss_b[2],
            self.gauss_b[3],
            self.gauss_b[4],
            self.gauss_b[5],
        )
        self.gauss_c = (
            self.gauss_b[0],
            self.gauss_b[1],
            self.gauss_b[2],
            self.gauss_b[3],
            self.gauss_b[4],
            self.gauss_b[5],
        )
        self.sums()
        settled = SETTLED * (self.mode_sum + duration * self.rate_sum) + 1e-30
        before = 1e300
        change = 1e300
        for sweep in range(MOST_SWEEPS):
            self.visit_first(duration)
            self.found_a = self.rates_at(share + FIRST * taken)
            self.visit_second(duration)
            self.found_b = self.rates_at(share + 0.5 * taken)
            self.visit_third(duration)
            self.found_c = self.rates_at(share + LAST * taken)
            change = self.correct(share + 0.5 * taken, duration)
            if change <= settled or not change < 1e200:
                break
            if sweep > 4 and change > 0.8 * before:
                break
            before = change
        if not change <= settled:
            return False
        self.account(share, taken, duration)
        self.visit_end(duration)
        return True

    def placed(self, place: int, share: float, a: float, b: float, c: float, duration: float) -> float:
        """A mode at a stage, from the accelerations at all three."""
        bent = a * self.gauss_a[place] + b * self.gauss_b[place] + c * self.gauss_c[place]
        return self.mode[place] + duration * (share * self.mode_rate[place] + duration * bent)

    def sped(self, place: int, a: float, b: float, c: float, duration: float) -> float:
        """Rate of a mode at a stage, from the accelerations at all three."""
        bent = a * self.gauss_a[place] + b * self.gauss_b[place] + c * self.gauss_c[place]
        return self.mode_rate[place] + duration * bent

    def visit_first(self, duration: float) -> None:
        """Make the modes at the first stage the trial place."""
        self.trial = (
            self.placed(0, FIRST, SQUARE_11, SQUARE_12, SQUARE_13, duration),
            self.placed(1, FIRST, SQUARE_11, SQUARE_12, SQUARE_13, duration),
            self.placed(2, FIRST, SQUARE_11, SQUARE_12, SQUARE_13, duration),
            self.placed(3, FIRST, SQUARE_11, SQUARE_12, SQUARE_13, duration),
            self.placed(4, FIRST, SQUARE_11, SQUARE_12, SQUARE_13, duration),
            self.placed(5, FIRST, SQUARE_11, SQUARE_12, SQUARE_13, duration),
        )
        self.trial_rate = (
            self.sped(0, GAUSS_11, GAUSS_12, GAUSS_13, duration),
            self.sped(1, GAUSS_11, GAUSS_12, GAUSS_13, duration),
            self.sped(2, GAUSS_11, GAUSS_12, GAUSS_13, duration),
            self.sped(3, GAUSS_11, GAUSS_12, GAUSS_13, duration),
            self.sped(4, GAUSS_11, GAUSS_12, GAUSS_13, duration),
            self.sped(5, GAUSS_11, GAUSS_12, GAUSS_13, duration),
        )

    def visit_second(self, duration: float) -> None:
        """Make the modes at the second stage the trial place."""
        self.trial = (
            self.placed(0, 0.5, SQUARE_21, SQUARE_22, SQUARE_23, duration),
            self.placed(1, 0.5, SQUARE_21, SQUARE_22, SQUARE_23, duration),
            self.placed(2, 0.5, SQUARE_21, SQUARE_22, SQUARE_23, duration),
            self.placed(3, 0.5, SQUARE_21, SQUARE_22, SQUARE_23, duration),
            self.placed(4, 0.5, SQUARE_21, SQUARE_22, SQUARE_23, duration),
            self.placed(5, 0.5, SQUARE_21, SQUARE_22, SQUARE_23, duration),
        )
        self.trial_rate = (
            self.sped(0, GAUSS_21, GAUSS_22, GAUSS_23, duration),
            self.sped(1, GAUSS_21, GAUSS_22, GAUSS_23, duration),
            self.sped(2, GAUSS_21, GAUSS_22, GAUSS_23, duration),
            self.sped(3, GAUSS_21, GAUSS_22, GAUSS_23, duration),
            self.sped(4, GAUSS_21, GAUSS_22, GAUSS_23, duration),
            self.sped(5, GAUSS_21, GAUSS_22, GAUSS_23, duration),
        )

    def visit_third(self, duration: float) -> None:
        """Make the modes at the third stage the trial place."""
        self.trial = (
            self.placed(0, LAST, SQUARE_31, SQUARE_32, SQUARE_33, duration),
            self.placed(1, LAST, SQUARE_31, SQUARE_32, SQUARE_33, duration),
            self.placed(2, LAST, SQUARE_31, SQUARE_32, SQUARE_33, duration),
            self.placed(3, LAST, SQUARE_31, SQUARE_32, SQUARE_33, duration),
            self.placed(4, LAST, SQUARE_31, SQUARE_32, SQUARE_33, duration),
            self.placed(5, LAST, SQUARE_31, SQUARE_32, SQUARE_33, duration),
        )
        self.trial_rate = (
            self.sped(0, GAUSS_31, GAUSS_32, GAUSS_33, duration),
            self.sped(1, GAUSS_31, GAUSS_32, GAUSS_33, duration),
            self.sped(2, GAUSS_31, GAUSS_32, GAUSS_33, duration),
            self.sped(3, GAUSS_31, GAUSS_32, GAUSS_33, duration),
            self.sped(4, GAUSS_31, GAUSS_32, GAUSS_33, duration),
            self.sped(5, GAUSS_31, GAUSS_32, GAUSS_33, duration),
        )

    def visit_end(self, duration: float) -> None:
        """Make the modes at the end of the integration step the trial place."""
        self.trial = (
            self.placed(0, 1.0, PLACE_A, PLACE_B, PLACE_C, duration),
            self.placed(1, 1.0, PLACE_A, PLACE_B, PLACE_C, duration),
            self.placed(2, 1.0, PLACE_A, PLACE_B, PLACE_C, duration),
            self.placed(3, 1.0, PLACE_A, PLACE_B, PLACE_C, duration),
            self.placed(4, 1.0, PLACE_A, PLACE_B, PLACE_C, duration),
            self.placed(5, 1.0, PLACE_A, PLACE_B, PLACE_C, duration),
        )
        self.trial_rate = (
            self.sped(0, OUTER, INNER, OUTER, duration),
            self.sped(1, OUTER, INNER, OUTER, duration),
            self.sped(2, OUTER, INNER, OUTER, duration),
            self.sped(3, OUTER, INNER, OUTER, duration),
            self.sped(4, OUTER, INNER, OUTER, duration),
            self.sped(5, OUTER, INNER, OUTER, duration),
        )

    def go_on(self) -> None:
        """Make the trial place the present one, and count the work up to there."""
        self.mode = (self.trial[0], self.trial[1], self.trial[2], self.trial[3], self.trial[4], self.trial[5])
        self.mode_rate = (
            self.trial_rate[0],
            self.trial_rate[1],
            self.trial_rate[2],
            self.trial_rate[3],
            self.trial_rate[4],
            self.trial_rate[5],
        )
        self.push_work = self.push_work + self.step_push
        self.guide_work = self.guide_work + self.step_guide
        self.lost_work = self.lost_work + self.step_loss
        self.energy_through = self.energy_through + self.step_through

    def correct(self, share: float, duration: float) -> float:
        """Correct the accelerations of all stages for what was found; how far that moves the modes."""
        length = self.length_at(share)
        pushed = self.pushed_at(share)
        square = duration * duration
        a1, b1, c1 = self.correction(0, length, pushed, square)
        a2, b2, c2 = self.correction(1, length, pushed, square)
        a3, b3, c3 = self.correction(2, length, pushed, square)
        a4, b4, c4 = self.correction(3, length, pushed, square)
        a5, b5, c5 = self.correction(4, length, pushed, square)
        a6, b6, c6 = self.correction(5, length, pushed, square)
        self.gauss_a = (
            self.gauss_a[0] + a1,
            self.gauss_a[1] + a2,
            self.gauss_a[2] + a3,
            self.gauss_a[3] + a4,
            self.gauss_a[4] + a5,
            self.gauss_a[5] + a6,
        )
        self.gauss_b = (
            self.gauss_b[0] + b1,
            self.gauss_b[1] + b2,
            self.gauss_b[2] + b3,
            self.gauss_b[3] + b4,
            self.gauss_b[4] + b5,
            self.gauss_b[5] + b6,
        )
        self.gauss_c = (
            self.gauss_c[0] + c1,
            self.gauss_c[1] + c2,
            self.gauss_c[2] + c3,
            self.gauss_c[3] + c4,
            self.gauss_c[4] + c5,
            self.gauss_c[5] + c6,
        )
        largest = fabs(a1) + fabs(a2) + fabs(a3) + fabs(a4) + fabs(a5) + fabs(a6)
        largest = largest + fabs(b1) + fabs(b2) + fabs(b3) + fabs(b4) + fabs(b5) + fabs(b6)
        return square * (largest + fabs(c1) + fabs(c2) + fabs(c3) + fabs(c4) + fabs(c5) + fabs(c6))

    def correction(
        self, place: int, length: float, pushed: float, square: float
    ) -> tuple[float, float, float]:
        """Change of the accelerations of a mode, its own stiffness being taken into account."""
        wave = (place + 1) * pi / length
        stiff = wave * wave * (self.stiffness * wave * wave - pushed) / self.belt_mass
        return corrected(
            square * stiff if stiff > 0.0 else 0.0,
            self.found_a[place] - self.gauss_a[place],
            self.found_b[place] - self.gauss_b[place],
            self.found_c[place] - self.gauss_c[place],
        )

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
