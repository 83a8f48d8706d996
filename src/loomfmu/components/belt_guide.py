"""How guide and head hold the ends of the belt: in its guide it turns freely up to a slope."""

from dataclasses import dataclass
from math import fabs

from ..physics.belt_bending import bent_belt
from ..physics.belt_ends import (
    OTHER,
    OWN,
    end_amplitudes,
    end_motion,
    end_slopes,
    turning,
)
from ..physics.belt_modes import bow_forces, first_modes
from .belt_dynamics_variables import BeltDynamicsVariables

CALIBRATED = 1  # guide: pinned, with a stiffness that makes up for it
GUIDED = 2  # head: it cannot turn
TOUCHING = 1e-6  # of the modes: a turn that close to the free one is at the stop
SHORTEST_SHARE = 5e-3  # of an integration step: it goes that far at least, however contact comes and goes


@dataclass(slots=True)
class BeltGuide(BeltDynamicsVariables):
    """Which ends of the belt are clamped, and when that changes."""

    def clamped(self) -> int:
        """Ends that cannot turn: 0 none, 1 at the guide, 2 at the head, 3 both."""
        return (1 if self.guide_contact != 0 else 0) + (2 if self.head_end == GUIDED else 0)

    def free_turn(self, length: float) -> float:
        """Slope up to which the belt turns freely in its guide, counted from its line, times its length."""
        return (length / self.guide_length + 0.5) * self.guide_clearance

    def may_clamp(self) -> bool:
        """Whether an end may be clamped at some time."""
        return self.guide_end != CALIBRATED or self.head_end == GUIDED

    def turn(self, length: float) -> float:
        """Slope at the guide on which the belt leans, times its length."""
        return self.guide_contact * self.free_turn(length)

    def turn_by_length(self) -> float:
        """Rate of `turn` by the length."""
        return self.guide_contact * self.guide_clearance / self.guide_length

    def bow_moments(self, length: float) -> tuple[float, float, float, float, float, float]:
        """Moments of the bow on all modes."""
        b1, b2, b3, b4, b5, b6, _d1, _d2, _d3, _d4, _d5, _d6 = bow_forces(
            self.bow_of, self.bow, self.bow_length, length
        )
        flexural = self.stiffness
        return (
            flexural * b1,
            flexural * b2,
            flexural * b3,
            flexural * b4,
            flexural * b5,
            flexural * b6,
        )

    def end_bow(self, length: float) -> tuple[float, float, float, float, float, float]:
        """Amplitudes of the end shapes at guide and head where both turn freely, and two rates by L."""
        return end_amplitudes(self.bow_of, self.bow, self.bow_length, length, self.may_clamp())

    def ends(
        self, length: float, velocity: float
    ) -> tuple[float, float, float, float, float, float, float, float, float, float]:
        """The end shapes in the trial place of a belt at a constant velocity, see `end_motion`."""
        e, h, e_by_length, h_by_length, e_second, h_second = self.end_bow(length)
        return end_motion(  # type: ignore[call-arg]
            *self.trial,  # type: ignore[arg-type]
            *self.trial_rate,
            velocity,
            0.0,
            self.clamped(),
            self.turn(length),
            self.turn_by_length(),
            e,
            h,
            e_by_length,
            h_by_length,
            e_second,
            h_second,
        )

    def bend(
        self, length: float, velocity: float
    ) -> tuple[
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
        float,
    ]:
        """Bending and shortening in the trial place, see `bent_belt`, of a belt at a constant velocity."""
        (
            _d,
            _k,
            guide,
            head,
            guide_rate,
            head_rate,
            guide_by_length,
            head_by_length,
            guide_second,
            head_second,
        ) = self.ends(length, velocity)
        return bent_belt(  # type: ignore[call-arg]
            *self.trial,  # type: ignore[arg-type]
            *self.trial_rate,
            length,
            velocity,
            0.0,
            self.clamped(),
            guide,
            head,
            guide_rate,
            head_rate,
            guide_by_length,
            head_by_length,
            guide_second,
            head_second,
        )

    def lag(self, length: float, velocity: float) -> tuple[float, float, float, float, float, float, float]:
        """Rates of the shortening in the trial place, by the modes that move and in time."""
        (
            _f1,
            _f2,
            _f3,
            _f4,
            _f5,
            _f6,
            g1,
            g2,
            g3,
            g4,
            g5,
            g6,
            _short,
            rate,
            _second,
            _by_length,
            _energy,
            _growth,
            _turned_force,
            _turned_pull,
        ) = self.bend(length, velocity)
        g1, g2, g3, g4, g5, g6 = first_modes(self.modes, g1, g2, g3, g4, g5, g6)
        return g1, g2, g3, g4, g5, g6, rate

    def free_slope(self, length: float, velocity: float) -> tuple[float, float]:
        """Slope at the guide times the length, as if the belt turned freely there, and its rate."""
        e, h, e_by_length, h_by_length, _e_second, _h_second = self.end_bow(length)
        guide, head = end_slopes(*self.trial)
        guide_rate, head_rate = end_slopes(*self.trial_rate)
        guide_growth, head_growth = turning(0.0, e_by_length, h_by_length)
        turn = guide + OWN * e + OTHER * h
        rate = guide_rate - guide_growth * velocity
        if self.head_end == GUIDED:
            turn = turn - OTHER / OWN * (head + OTHER * e + OWN * h)
            rate = rate - OTHER / OWN * (head_rate - head_growth * velocity)
        return turn, rate

    def has_play(self) -> bool:
        """Whether the belt turns freely in its guide, up to a slope."""
        return self.guide_end != CALIBRATED and self.guide_clearance > 0.0

    def lean(self, length: float) -> None:
        """Find on which side of its guide the belt leans in its trial place, if it does."""
        turn, _rate = self.free_slope(length, 0.0)
        self.guide_contact = 0
        if self.guide_end != CALIBRATED and fabs(turn) >= self.free_turn(length):
            self.guide_contact = -1 if turn < 0.0 and self.guide_clearance > 0.0 else 1

    def gap(self, turn: float, rate: float, length: float, velocity: float, side: int) -> tuple[float, float]:
        """By how much contact on a side, or its absence, fits a `free_slope`, negative if not; its rate."""
        beyond = side * turn - self.free_turn(length)
        growth = side * rate - self.guide_clearance / self.guide_length * velocity
        if self.guide_contact != 0:
            return beyond, growth
        return -beyond, -growth

    def side(self, turn: float) -> int:
        """Side of the guide on which the belt leans, or to which it is turned by its `free_slope`."""
        if self.guide_contact != 0:
            return self.guide_contact
        return 1 if turn >= 0.0 else -1
