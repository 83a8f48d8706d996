"""Claims on the whole loom: its mechanisms keep out of each other's way."""

from collections.abc import Sequence

from ..cosim.claims.arguments import Edges, Flag, Name, Names, Quantity, Window, argument
from ..cosim.claims.claim import AT_LEAST, AT_MOST, LENGTH, ONE, SPEED, VELOCITY, Claim
from ..cosim.claims.conditions import Always, Condition, Sometime, Sum, Unprovable
from ..cosim.claims.judging import Form, Question, needs_shaft
from ..cosim.claims.movers import Wired
from ..errors import LoomfmuError
from ..traces import Signals
from ..traces.verdict import REED_DISTANCE, SHED_OPENING
from .lifted import check_lifted_by, frames_of, height_of, lift_of


class _InShed(Claim, kind=False):
    """A claim on the time while the rapier head is in the shed: its travel exceeds the idle travel."""

    weft: str = argument(Name(), "weft")
    belt: str = argument(Name(), "belt")

    reads = ("belt",)
    unit = LENGTH

    @property
    def outside(self) -> Sum:
        """Return what is not negative while the head is not in the shed."""
        return Sum(((1.0, f"{self.belt}.idle_travel"), (-1.0, f"{self.weft}.travel")))


class RapierInOpenShed(_InShed):
    """While the rapier head is in the shed, every warp sheet leaves it its height.

    At the rapier's station each frame's warp must then be at least half the head's height above or below the
    closed shed. What is judged is twice the least distance of any frame, and 0 if its warp crosses the closed
    shed meanwhile. Where a frame has a damper, its warp is as high as the carrier lifts it, unless
    `lifted_by` is "frame".
    """

    head_height: float = argument(Quantity("m", "mm", usual=0.03, low=0.0))
    healds: Sequence[str] = argument(Names(), ())
    lifted_by: str = argument(Name(), "")

    def signals(self, scene: Wired) -> list[str]:
        check_lifted_by(self.lifted_by, ())  # it judges several frames, and a damper belongs to one
        frames = self.healds or frames_of(scene)
        wanted = [f"{frame}.{variable}" for frame in frames for variable in ("lift", "warp_height")]
        carriers = [lift_of(frame, self.lifted_by, scene) for frame in frames]
        return list(dict.fromkeys([f"{self.weft}.travel", *wanted, *carriers]))

    def question(self, trace: Signals) -> Question:
        frames = self.healds or frames_of(trace)
        if not frames:
            raise LoomfmuError("rapier_in_open_shed: the run records no heald frame")
        check_lifted_by(self.lifted_by, ())
        signals = [f"{self.weft}.travel"]
        forms, numbers = list[Form](), list[float | str]()
        for frame in frames:
            own, lift = f"{frame}.lift", lift_of(frame, self.lifted_by, trace)
            named = f"2 |{frame}.warp_height|" if lift == own else f"2 |warp height by {lift}|"
            forms.append(self.form(SHED_OPENING, named))
            signals += (lift, own)
            numbers += (f"{frame}.stroke", f"{frame}.warp_ratio")
        return Question("shed", forms, signals, [self.head_height, f"{self.belt}.idle_travel", *numbers])

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        heights = [height_of(frame, self.lifted_by, run) for frame in self.healds or frames_of(run)]
        if not heights:
            raise Unprovable("the scene has no heald frame")
        room = 0.5 * self.head_height
        return (
            Sometime(self.outside.negated),
            *(
                Always((self.outside, Sum(((1.0, height),), -room), Sum(((-1.0, height),), -room)))
                for height in heights
            ),
        )


class ReedClearOfRapier(_InShed):
    """While the rapier head is in the shed, the reed stays a distance behind its front limit."""

    clearance: float = argument(Quantity("m", "mm", usual=0.03, low=0.0))
    reed: str = argument(Name(), "reed")

    needs = ("reed.position", "reed.front_limit", "weft.travel")

    def question(self, trace: Signals) -> Question:
        limit, position = f"{self.reed}.front_limit", f"{self.reed}.position"
        form = self.form(REED_DISTANCE, f"{limit} - {position}")
        signals = [f"{self.weft}.travel", position, limit]
        return Question("reed", [form], signals, [self.clearance, f"{self.belt}.idle_travel"])

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        distance = ((1.0, f"{self.reed}.front_limit"), (-1.0, f"{self.reed}.position"))
        return Sometime(self.outside.negated), Always((self.outside, Sum(distance, -self.clearance)))


class _Transfer(Claim, kind=False):
    """A claim on the transfer: the hand-over lasts while the heads overlap by what the hooks need."""

    transfer: str = argument(Name(), "transfer")

    reads = ("transfer",)

    @property
    def apart(self) -> Sum:
        """Return what is not negative while the heads overlap by no more than the hooks need."""
        return Sum(((1.0, f"{self.transfer}.needed_overlap"), (-1.0, f"{self.transfer}.overlap")))


class TransferInTime(_Transfer):
    """In every revolution the heads overlap by what the hooks need, within a window of shaft angles.

    The largest overlap in each pass through the window is judged, and the least of these decides. Passes of
    which the run has only a part do not count.
    """

    window: Window = argument(Edges("rad", "deg", usual=1.5))

    needs = ("transfer.overlap",)
    unit = LENGTH

    def question(self, trace: Signals) -> Question:
        needs_shaft(trace)
        signal, window = f"{self.transfer}.overlap", self.window
        numbers = (f"{self.transfer}.needed_overlap", window.start, window.width)
        return Question(
            "transfer", [self.form(f"overlap of the heads {window.words}", signal)], [signal], numbers
        )

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        return (Sometime(self.apart.negated, self.window),)


class TransferSpeed(_Transfer):
    """While the heads overlap by what the hooks need, they move no faster relative to each other."""

    at_most: float = argument(Quantity("m/s", low=0.0))

    needs = ("transfer.overlap", "transfer.closing_velocity")
    sense, unit = AT_MOST, VELOCITY

    def question(self, trace: Signals) -> Question:
        signal = f"{self.transfer}.closing_velocity"
        signals = [f"{self.transfer}.overlap", signal]
        numbers = (self.at_most, f"{self.transfer}.needed_overlap")
        form = self.form("highest relative speed of the heads", signal)
        return Question("transfer_speed", [form], signals, numbers)

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        speed = f"{self.transfer}.closing_velocity"
        bounded = (Always((self.apart, Sum(((side, speed),), self.at_most))) for side in (1.0, -1.0))
        return (Sometime(self.apart.negated), *bounded)


class NipHolds(Claim):
    """The nip's largest holding force, while fibres are drafted, is 2 to 3 times the largest drafting force.

    Below that the web slips in the nip, above it the top roller is loaded for nothing. The forces of a roller
    are known only at the samples: with `at_samples` these are judged.
    """

    roller: str = argument(Name(), "roller")
    at_least: float = argument(Quantity("1", low=0.0), 2.0)
    at_most: float = argument(Quantity("1", low=0.0), 3.0)
    at_samples: bool = argument(Flag(), False)

    needs = ("roller.holding_force", "roller.drafting_force")

    def question(self, trace: Signals) -> Question:
        text = "holding force over drafting force" + " at the samples" * self.at_samples
        signal = f"{self.roller}.holding_force / drafting_force"
        forms = [Form(text, signal, self.unit, sense) for sense in (AT_LEAST, AT_MOST)]
        signals = [f"{self.roller}.drafting_force", f"{self.roller}.holding_force"]
        return Question("nip", forms, signals, [self.at_least, self.at_most, float(self.at_samples)])


class LocksInTime(Claim):
    """The pattern locks follow their law and let go within the time that they have.

    Both hold up to a speed of its shaft that the lock computes, so the highest speed of that shaft is judged.
    """

    lock: str = argument(Name(), "lock")

    needs = ("lock.in_time", "lock.torque_margin", "lock.speed_limit")
    sense, unit = AT_MOST, SPEED

    def signals(self, scene: Wired) -> list[str]:
        return [*super().signals(scene), *filter(None, [self._velocity(scene)])]

    def _velocity(self, run: Wired) -> str:
        """The velocity of the lock's shaft; "" if it turns by itself."""
        source = run.wires.get(f"{self.lock}.shaft_velocity", "")
        if source in run and (unit := run.unit(source)) != SPEED[0]:
            raise LoomfmuError(f"{self.lock} has its speed from {source} in {unit}; it must be in {SPEED[0]}")
        return source

    def question(self, trace: Signals) -> Question:
        velocity, margin = self._velocity(trace), f"{self.lock}.torque_margin"
        forms = [
            self.form("highest speed of the shaft", velocity),
            Form("torque margin", margin, ONE, AT_LEAST),  # of a lock that does not follow the shaft
        ]
        signals = [f"{self.lock}.speed_limit", f"{self.lock}.in_time", margin]
        return Question("locks", forms, [*signals, velocity], [0.0])

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        if not (velocity := self._velocity(run)):
            return super().conditions(run)
        limit = f"{self.lock}.speed_limit"
        return tuple(Always((Sum(((1.0, limit), (side, velocity))),)) for side in (1.0, -1.0))
