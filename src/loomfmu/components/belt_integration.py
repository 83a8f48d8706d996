"""How BeltDynamics integrates its modes: a step of Gauss's method, and its work."""

from dataclasses import dataclass
from math import fabs, pi

from ..physics.belt_ends import OTHER, OWN, at_ends
from ..physics.belt_modes import first_modes, same, size, summed
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
    held,
    stage,
)
from .belt_path import BeltPath

MOST_REPEATS = 30  # of the sweep over the stages, until the accelerations of an integration step are settled
SETTLED = 1e-11  # of the modes: what a sweep may still change


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
        self.foresee(share, duration)
        self.sums()
        self.bow_a = self.bow_moments(self.length_at(share + FIRST * taken))
        self.end_a = self.scaled_end_bow(self.length_at(share + FIRST * taken))
        self.bow_b = self.bow_moments(self.length_at(share + 0.5 * taken))
        self.end_b = self.scaled_end_bow(self.length_at(share + 0.5 * taken))
        self.bow_c = self.bow_moments(self.length_at(share + LAST * taken))
        self.end_c = self.scaled_end_bow(self.length_at(share + LAST * taken))
        settled = SETTLED * (self.mode_sum + duration * self.rate_sum) + 1e-30
        before = 1e300
        change = 1e300
        for repeat in range(MOST_REPEATS):
            self.sweeps = self.sweeps + 1
            self.visit_first(duration)
            self.found_a = self.stage_rates(share + FIRST * taken, *self.bow_a, *self.end_a)
            self.load_a = self.compression
            self.visit_second(duration)
            self.found_b = self.stage_rates(share + 0.5 * taken, *self.bow_b, *self.end_b)
            self.load_b = self.compression
            self.visit_third(duration)
            self.found_c = self.stage_rates(share + LAST * taken, *self.bow_c, *self.end_c)
            self.load_c = self.compression
            change = self.correct(share + 0.5 * taken, duration)
            if change <= settled or not change < 1e200:
                break
            if repeat > 4 and change > 0.8 * before:
                break
            before = change
        if not change <= settled:
            return False
        self.visit_end(duration)
        return True

    def foresee(self, share: float, duration: float) -> None:
        """First accelerations of the stages: by the parabola of the last integration step, or those now."""
        if self.gauss_step <= 0.0:
            self.try_modes()
            self.gauss_b = self.rates_at(share)
            self.gauss_a = same(*self.gauss_b)
            self.gauss_c = same(*self.gauss_b)
            return
        longer = duration / self.gauss_step
        self.gauss_step = 0.0
        self.found_a = self.foreseen(1.0 + FIRST * longer)
        self.found_b = self.foreseen(1.0 + 0.5 * longer)
        self.found_c = self.foreseen(1.0 + LAST * longer)
        self.gauss_a = same(*self.found_a)
        self.gauss_b = same(*self.found_b)
        self.gauss_c = same(*self.found_c)

    def foreseen(self, share: float) -> tuple[float, float, float, float, float, float]:
        """Accelerations at a share of the last integration step, beyond it, on the parabola of its stages."""
        far = (share - 0.5) / (LAST - 0.5)
        square = far * far
        return stage(
            0.0,
            0.5 * (square - far),
            1.0 - square,
            0.5 * (square + far),
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            *self.gauss_a,
            *self.gauss_b,
            *self.gauss_c,
        )

    def visit(
        self,
        duration: float,
        share: float,
        place_a: float,
        place_b: float,
        place_c: float,
        rate_a: float,
        rate_b: float,
        rate_c: float,
    ) -> None:
        """Make the modes at a share of the integration step the trial place, by the weights of its stages."""
        square = duration * duration
        self.trial = stage(
            duration * share,
            square * place_a,
            square * place_b,
            square * place_c,
            *self.mode,
            *self.mode_rate,
            *self.gauss_a,
            *self.gauss_b,
            *self.gauss_c,
        )
        self.trial_rate = stage(
            0.0,
            duration * rate_a,
            duration * rate_b,
            duration * rate_c,
            *self.mode_rate,
            *self.mode_rate,
            *self.gauss_a,
            *self.gauss_b,
            *self.gauss_c,
        )

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
        self.found_a = summed(-1.0, *self.gauss_a, *self.found_a)
        self.found_b = summed(-1.0, *self.gauss_b, *self.found_b)
        self.found_c = summed(-1.0, *self.gauss_c, *self.found_c)
        if self.clamped() != 0:
            self.hold_ends(length, pushed, square)
        a1, b1, c1 = self.corrected_mode(0, length, pushed, square)
        a2, b2, c2 = self.corrected_mode(1, length, pushed, square)
        a3, b3, c3 = self.corrected_mode(2, length, pushed, square)
        a4, b4, c4 = self.corrected_mode(3, length, pushed, square)
        a5, b5, c5 = self.corrected_mode(4, length, pushed, square)
        a6, b6, c6 = self.corrected_mode(5, length, pushed, square)
        self.gauss_a = summed(1.0, a1, a2, a3, a4, a5, a6, *self.gauss_a)
        self.gauss_b = summed(1.0, b1, b2, b3, b4, b5, b6, *self.gauss_b)
        self.gauss_c = summed(1.0, c1, c2, c3, c4, c5, c6, *self.gauss_c)
        largest = size(a1, a2, a3, a4, a5, a6) + size(b1, b2, b3, b4, b5, b6)
        return square * (largest + size(c1, c2, c3, c4, c5, c6))

    def corrected_mode(
        self, place: int, length: float, pushed: float, square: float
    ) -> tuple[float, float, float]:
        """Change of the accelerations of a mode at all stages for what they are off by."""
        stiff = square * self.stiff(place + 1, length, pushed)
        return corrected(stiff, self.found_a[place], self.found_b[place], self.found_c[place])

    def hold_ends(self, length: float, pushed: float, square: float) -> None:
        """Take from what the accelerations are off by the share of the moments at the clamped ends.

        They act on all modes at once: on odd and on even ones alike if one end is clamped, on either kind by
        itself if both are.
        """
        stiff = 12.0 * square * self.stiffness / (self.belt_mass * length * length * length * length)
        o11, o12, o13, o21, o22, o23, o31, o32, o33, o1, o2, o3 = self.yielding(1, length, pushed, square)
        e11, e12, e13, e21, e22, e23, e31, e32, e33, e1, e2, e3 = self.yielding(2, length, pushed, square)
        clamped = self.clamped()
        if clamped == 3:
            o1, o2, o3 = held(
                2.0 * stiff / (OWN + OTHER), o11, o12, o13, o21, o22, o23, o31, o32, o33, o1, o2, o3
            )
            e1, e2, e3 = held(
                2.0 * stiff / (OWN - OTHER), e11, e12, e13, e21, e22, e23, e31, e32, e33, e1, e2, e3
            )
        else:
            sign = -1.0 if clamped == 1 else 1.0
            e1, e2, e3 = held(
                stiff / OWN,
                o11 + e11,
                o12 + e12,
                o13 + e13,
                o21 + e21,
                o22 + e22,
                o23 + e23,
                o31 + e31,
                o32 + e32,
                o33 + e33,
                e1 + sign * o1,
                e2 + sign * o2,
                e3 + sign * o3,
            )
            o1, o2, o3 = sign * e1, sign * e2, sign * e3
        a1, a2, a3, a4, a5, a6 = at_ends(-o1, -e1)
        a1, a2, a3, a4, a5, a6 = summed(1.0, a1, a2, a3, a4, a5, a6, *self.found_a)
        self.found_a = first_modes(self.modes, a1, a2, a3, a4, a5, a6)
        a1, a2, a3, a4, a5, a6 = at_ends(-o2, -e2)
        a1, a2, a3, a4, a5, a6 = summed(1.0, a1, a2, a3, a4, a5, a6, *self.found_b)
        self.found_b = first_modes(self.modes, a1, a2, a3, a4, a5, a6)
        a1, a2, a3, a4, a5, a6 = at_ends(-o3, -e3)
        a1, a2, a3, a4, a5, a6 = summed(1.0, a1, a2, a3, a4, a5, a6, *self.found_c)
        self.found_c = first_modes(self.modes, a1, a2, a3, a4, a5, a6)

    def yielding(
        self, first: int, length: float, pushed: float, square: float
    ) -> tuple[float, float, float, float, float, float, float, float, float, float, float, float]:
        """How far end slopes yield to moments there at all stages, and to what the accelerations are off by.

        Those of the odd modes (1 first) or of the even ones (2): a matrix over the stages, then a vector.
        """
        y11, y12, y13, y21, y22, y23, y31, y32, y33 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        s1, s2, s3 = 0.0, 0.0, 0.0
        for number in range(first, self.modes + 1, 2):
            wave = number * pi
            stiff = square * self.stiff(number, length, pushed)
            c1, c2, c3 = corrected(stiff, SQUARE_11, SQUARE_21, SQUARE_31)
            y11, y21, y31 = y11 + wave * wave * c1, y21 + wave * wave * c2, y31 + wave * wave * c3
            c1, c2, c3 = corrected(stiff, SQUARE_12, SQUARE_22, SQUARE_32)
            y12, y22, y32 = y12 + wave * wave * c1, y22 + wave * wave * c2, y32 + wave * wave * c3
            c1, c2, c3 = corrected(stiff, SQUARE_13, SQUARE_23, SQUARE_33)
            y13, y23, y33 = y13 + wave * wave * c1, y23 + wave * wave * c2, y33 + wave * wave * c3
            c1, c2, c3 = self.corrected_mode(number - 1, length, pushed, square)
            s1, s2, s3 = s1 + wave * c1, s2 + wave * c2, s3 + wave * c3
        return (
            y11,
            y12,
            y13,
            y21,
            y22,
            y23,
            y31,
            y32,
            y33,
            SQUARE_11 * s1 + SQUARE_12 * s2 + SQUARE_13 * s3,
            SQUARE_21 * s1 + SQUARE_22 * s2 + SQUARE_23 * s3,
            SQUARE_31 * s1 + SQUARE_32 * s2 + SQUARE_33 * s3,
        )

    def stiff(self, number: int, length: float, pushed: float) -> float:
        """Square of the frequency of a mode, 0 for one that grows."""
        wave = number * pi / length
        stiff = wave * wave * (self.stiffness * wave * wave - pushed) / self.belt_mass
        return stiff if stiff > 0.0 else 0.0

    def account(self, share: float, taken: float) -> None:
        """Add up the work of an integration step by Gauss's quadrature at its stages."""
        duration = taken * self.path_step
        self.step_push = 0.0
        self.step_guide = 0.0
        self.step_loss = 0.0
        self.step_through = 0.0
        self.visit_first(duration)
        self.work(share + FIRST * taken, OUTER * duration, self.load_a, *self.gauss_a)
        self.visit_second(duration)
        self.work(share + 0.5 * taken, INNER * duration, self.load_b, *self.gauss_b)
        self.visit_third(duration)
        self.work(share + LAST * taken, OUTER * duration, self.load_c, *self.gauss_c)
        self.visit_end(duration)

    def work(
        self,
        share: float,
        time: float,
        load: float,
        a1: float,
        a2: float,
        a3: float,
        a4: float,
        a5: float,
        a6: float,
    ) -> None:
        """Add the work of all powers at a stage over a time."""
        length = self.length_at(share)
        _energy, push, guide, loss = energy_and_powers(  # type: ignore[call-arg]
            *self.trial,  # type: ignore[arg-type]
            *self.trial_rate,
            a1,
            a2,
            a3,
            a4,
            a5,
            a6,
            length,
            self.velocity_at(share),
            self.acceleration_at(share),
            self.tension_at(share),
            self.head_mass,
            self.belt_mass,
            2.0 * self.belt_mass * self.damping,
            self.stiffness,
            self.bow_of,
            self.bow,
            self.bow_length,
            self.guide_offset,
            self.may_clamp(),
            self.clamped(),
            self.turn(length),
            self.turn_by_length(),
            load,
        )
        self.step_push = self.step_push + time * push
        self.step_guide = self.step_guide + time * guide
        self.step_loss = self.step_loss + time * loss
        self.step_through = self.step_through + time * (fabs(push) + fabs(guide) + fabs(loss))

    def energy_at(self, share: float) -> float:
        """Energy of the trial place at a share of the step."""
        length = self.length_at(share)
        energy, _push, _guide, _loss = energy_and_powers(  # type: ignore[call-arg]
            *self.trial,  # type: ignore[arg-type]
            *self.trial_rate,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            length,
            self.velocity_at(share),
            self.acceleration_at(share),
            self.tension_at(share),
            self.head_mass,
            self.belt_mass,
            2.0 * self.belt_mass * self.damping,
            self.stiffness,
            self.bow_of,
            self.bow,
            self.bow_length,
            self.guide_offset,
            self.may_clamp(),
            self.clamped(),
            self.turn(length),
            self.turn_by_length(),
            0.0,
        )
        return energy
