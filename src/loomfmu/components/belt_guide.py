"""How guide and head hold the ends of the belt: in its guide it turns freely up to a slope."""

from dataclasses import dataclass
from math import fabs

from ..physics.belt_end_forces import end_pull
from ..physics.belt_ends import (
    OTHER,
    OWN,
    end_amplitudes,
    end_motion,
    end_slopes,
    turning,
)
from ..physics.belt_modes import bow_forces
from .belt_dynamics_variables import BeltDynamicsVariables

CALIBRATED = 1  # guide: pinned, with a stiffness that makes up for it
GUIDED = 2  # head: it cannot turn
TOUCHING = 1e-6  # of the modes: a turn that close to the free one is at the stop
SHORTEST_SHARE = 1e-4  # of an integration step: contact is not located more closely than that


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

    def end_bow(self, length: float) -> tuple[float, float, float, float]:
        """Amplitudes of the end shapes at guide and head where both turn freely, and their rates by L."""
        b1, b2, b3, b4, b5, b6, d1, d2, d3, d4, d5, d6 = bow_forces(
            self.bow_of, self.bow, self.bow_length, length
        )
        return end_amplitudes(
            self.bow_of, self.bow, self.bow_length, length, self.may_clamp(), b1, b2, b3, b4, b5, b6, d1, d2,
            d3, d4, d5, d6,
        )  # fmt: skip

    def end_excess(self, length: float, velocity: float) -> tuple[float, float, float, float]:
        """What the end shapes at guide and head exceed those of the bow by, and their rates."""
        e, h, e_by_length, h_by_length = self.end_bow(length)
        return end_motion(  # type: ignore[call-arg]
            *self.trial,  # type: ignore[arg-type]
            *self.trial_rate, velocity, self.clamped(), self.turn(length), self.turn_by_length(), e, h,
            e_by_length, h_by_length,
        )  # fmt: skip

    def moment_at_guide(self) -> float:
        """Moment by which the guide keeps the belt from turning, by the end shapes and the push on them."""
        length = self.free_length
        guide, head, _guide_rate, _head_rate = self.end_excess(length, 0.0)
        e, h, _e_by_length, _h_by_length = self.end_bow(length)
        pull, _pull_head = end_pull(length, self.clamped(), e + guide, h + head)
        return 6.0 * self.stiffness * guide / (length * length) + self.compression * pull * length

    def free_slope(self, length: float, velocity: float) -> tuple[float, float]:
        """Slope at the guide times the length, as if the belt turned freely there, and its rate."""
        e, h, e_by_length, h_by_length = self.end_bow(length)
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
