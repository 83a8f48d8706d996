"""Rows: a prepared scene with many values, stepped and judged in C.

What does not depend on the values is done once for all rows. Where anything in a row is out of the ordinary,
such as a value out of its limits, a warning, or steps that may be too long, that row is left to be run as any
other: so every row has the verdicts that it has alone.
"""

import ctypes
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..declaring.upstream import sources_of, upstream
from ..fmi.native.libraries import library_of
from .claims.claim import Claim
from .claims.judging import FIELDS, Form
from .claims.movers import whole_turn
from .composed import MOST, ROOM, Composed
from .dependence import TOO_LONG
from .estimates import Estimates, coarseness, usual
from .importing.slave import Slave
from .master.grid import contradicted, passed_by
from .master.master import Interrupted
from .master.rows import Judged, RowRunner, Variable, Varied, parts_of
from .master.steppers import SOURCE
from .planning.plan import Stepping
from .planning.pruning import Pruned
from .planning.requested import Movements, Requested, parameter_of
from .scenes.graph import step_order
from .scenes.instances import altered
from .scenes.scene import Scene
from .scenes.values import Values
from .varying import Questions, Steps, allows, numbers_of, reads, turned, with_row

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
ROUNDING = 1e-9  # far above that of speeds and steps: rows within it are run as any other
DECIDED = FIELDS.index("decided")
ENOUGH, LEAST = 16, 0.3  # rows, and the share of them that must be final for more to be worth it


class Ran(NamedTuple):
    """The findings on rows in C; `clean` are those whose verdicts are final.

    `near` says, for each row and verdict, whether it is so near its bound that a numerical error may matter.
    `exact` are the verdicts by the mechanisms' own functions, `forms` the forms of each, `names` those of the
    claims, and `held` the last values of signals.
    """

    clean: Mask
    judged: Judged
    near: Mask
    exact: Mask
    forms: Sequence[Sequence[Form]]
    names: Sequence[str]
    held: Mapping[str, NDArray[Any]]


class RowsInC:
    """The rows of a pattern, whose parts these are; `claims` are all that are judged."""

    def __init__(
        self,
        requested: Requested,
        claims: Sequence[Claim],
        estimates: Estimates,
        composed: Composed,
        stepping: Callable[[], Stepping],
        values: Values,
    ):
        self._requested, self._claims, self._values = requested, claims, values
        self._estimates, self._composed, self._stepping = estimates, composed, stepping
        self._tried = self._final = 0  # rows that were run, and those that need not be run again

    @property
    def explained(self) -> tuple[str, ...]:
        """Return a line that says so where rows are not run in C."""
        return (f"many runs: one by one in Python, as {self.unfit}",) if self.unfit else ()

    @property
    def worth(self) -> bool:
        """Return whether enough of the rows so far were final: each of the others is run twice."""
        return self._tried < ENOUGH or self._final > LEAST * self._tried

    def count(self, final: Mask) -> None:
        """Take in which rows were final."""
        self._tried += len(final)
        self._final += int(final.sum())

    @cached_property
    def unfit(self) -> str:
        """Return why all rows are run one by one in Python; an empty text where they are not."""
        scene = self._requested.scene
        if scene.package is not None:
            return "a system package is read anew for each row"
        if scene.accuracy is not None:
            return "the steps are chosen anew for each row"
        if len(self._estimates.own_claims) < len(self._claims):
            return "claims on yes-or-no outputs are decided by others"
        for name, instance in scene.instances.items():
            fmu = instance.fmu
            if not fmu.trusted or fmu.flavour != "native" or fmu.fmi != 2 or scene.isolates(name):
                return f"{name} is no native FMU of FMI 2 made by loomfmu, in this process"
            if any(instance.doubts.values()):
                return f"the scene warns of a value of {name}"
        if step_order(scene.instances, scene.wires)[1]:
            return "the wires close a loop"
        for claim in self._claims:
            if type(claim).judge is not Claim.judge or type(claim).__module__.partition(".")[0] != "loomfmu":
                return f"the claim {claim.name or type(claim).__name__} is judged in Python"
        return "" if library_of(SOURCE) else "no compiler is installed"

    def takes(self, key: str) -> bool:
        """Return whether the values of a key may differ from row to row: numbers that switch nothing."""
        targets = self._values.targets(key)
        return bool(targets) and all(self._is_number(*each) for each in targets)

    def _is_number(self, name: str, variable: str) -> bool:
        instance = self._requested.scene.instances[name]
        facts, port = instance.fmu.facts, instance.fmu.ports[variable]
        switches = {each for v in facts.variables.values() for each in (v.when, v.unless)} if facts else set()
        return port.kind in ("Real", "Integer") and not port.numbers and variable not in switches

    def run(self, columns: Mapping[str, Floats], scene: Scene, held: Sequence[str], near: bool) -> Ran | None:
        """Run and judge rows, with the values of each key; None where all are to be run one by one.

        `scene` is that of one of the rows, `held` are signals to keep the last values of. With `near`
        only verdicts near their bounds are those of the mechanisms' own functions.
        """
        takers = self._takers(list(columns), scene.overrides)
        possible = self._possible(columns, takers)
        stepping = Steps(scene, takers, columns)
        if self._steps_differ(scene, stepping, takers):
            return None
        possible &= self._checked(scene, columns, takers)
        possible &= stepping.possible
        own = self._stepping()
        plan = own.plan(scene, stepping.grid)
        turning = turned(takers, plan.pruned)
        try:
            with own.stepped(plan) as master:
                if any(type(slave) is not Slave for slave in master.slaves.values()):
                    return None
                rows = Questions(RowRunner(master), own.recording(plan), self._claims)
                reached = self._reached(turning, plan.pruned, stepping)
                varied = Varied(turning, numbers_of(rows.named, takers), stepping.column, reached)
                rows.runner.prepare(rows.judging(), varied, self._estimates.angles)
                judged = rows.runner.run(stepping.table, possible)
                close = self._near(scene, rows.forms, judged.verdicts)
                exact = self._exact(judged, close | (not near))
                judged = self._composed_too(scene, rows, varied, takers, stepping, judged, exact)
        except Interrupted:
            raise KeyboardInterrupt("interrupted") from None
        clean = judged.clean & self._shown(scene, columns, takers, stepping, judged.fastest)
        names = [each.name for each in self._claims]
        return Ran(clean, judged, close, exact, rows.forms, names, rows.held(judged, held))

    def _exact(self, judged: Judged, wanted: Mask) -> Mask:
        """The verdicts that the mechanisms' own functions give: the wanted ones, and those undecided."""
        found: Mask = (wanted | (judged.verdicts[:, :, DECIDED] == 0.0)) & judged.clean[:, None]
        found[:, [each for each in range(found.shape[1]) if each not in self._composed.claims]] = False
        return found

    def _composed_too(
        self,
        scene: Scene,
        rows: Questions,
        varied: Varied,
        takers: Mapping[Variable, int],
        stepping: Steps,
        judged: Judged,
        exact: Mask,
    ) -> Judged:
        """Take in verdicts by the mechanisms' own functions, where C can; other rows are not clean."""
        rest: Mask = np.any(exact, axis=1)
        if not rest.any():
            return judged
        if not self._count(scene, stepping, takers):
            return judged._replace(clean=judged.clean & ~rest)
        counts = stepping.table[rest, -1]
        # in less room than the most that are divided row by row, C gives up before those end otherwise
        room = min(int(4.0 * np.max(counts, initial=0.0)) + ROOM, MOST // 2)
        composition = self._composed.composition(scene, rows.recording, room)
        composition.ask()
        composition.struct.count_column = stepping.table.shape[1] - 1
        others = [*varied.others, *numbers_of(composition.named, takers), *composition.settings(takers)]
        with composition.tangents.placed() as composition.struct.tangents:
            struct = ctypes.addressof(composition.struct)
            rows.runner.prepare(rows.judging(struct), replace(varied, others=others), self._estimates.angles)
            found = rows.runner.run(stepping.table, rest, exact[:, list(self._composed.claims)])
        again = exact & found.clean[:, None]
        judged.verdicts[again] = found.verdicts[again]
        notes = {place: note for place, note in judged.notes.items() if not again[place]}
        return judged._replace(clean=judged.clean & (found.clean | ~rest), notes=notes | found.notes)

    def _count(self, scene: Scene, stepping: Steps, takers: Mapping[Variable, int]) -> bool:
        """Count the steps of composed claims in each row; false where that takes more than arithmetic."""
        needed = sorted(self._composed.needed)
        if not self._composed.by_main_shaft or any(reads(scene, name, takers) for name in needed):
            return False
        movements, grid = Movements(self._requested), stepping.grid
        size = scene.step_size if stepping.size is None else stepping.size
        ends = grid.stop_time if stepping.size is None else grid.start + grid.steps * size
        longest = [movements.longest_step(scene, name)[0] for name in needed]
        with np.errstate(invalid="ignore"):  # of rows that are not possible
            stepping.add(self._composed.steps(ends, size * scene.steps_per_period, longest))
        return True

    def _takers(self, keys: Sequence[str], overrides: Mapping[str, Any]) -> dict[Variable, int]:
        """The variables that take the values of a row, each with its column; those that inherit one, too."""
        own = self._values.taken(keys, overrides)
        found = {variable: keys.index(key) for variable, key in own.items()}
        for name, parameter in self._values.inheriting(own):
            found[name, parameter] = found[self._requested.scene.instances[name].inherited[parameter]]
        return found

    def _possible(self, columns: Mapping[str, Floats], takers: Mapping[Variable, int]) -> Mask:
        """The rows whose values are within their limits. A zero may be given with a sign, which some lose."""
        table = np.column_stack(list(columns.values()))
        found: Mask = np.isfinite(table).all(axis=1) & ~(np.signbit(table) & (table == 0.0)).any(axis=1)
        for (name, variable), column in takers.items():
            port = self._requested.scene.instances[name].fmu.ports[variable]
            low, high = port.range
            values = table[:, column]
            found &= (low <= values) & (values <= high)
            if port.kind == "Integer":
                found &= (values == np.round(values)) & (np.abs(values) < 2**31)
        return found

    def _steps_differ(self, scene: Scene, stepping: Steps, takers: Mapping[Variable, int]) -> bool:
        """Return whether inputs that the scene drives may not go with the steps of each row."""
        rates = {
            (drive.instance, rate)
            for drive in scene.drives
            if (rate := scene.instances[drive.instance].fmu.ports[drive.variable].rate)
        }
        differ = stepping.size is not None and (stepping.grid.points is not None or rates)
        return bool(differ or rates & takers.keys() or passed_by(scene) or contradicted(scene))

    def _checked(self, scene: Scene, columns: Mapping[str, Floats], takers: Mapping[Variable, int]) -> Mask:
        """The rows with parameters that no claim refuses."""
        table, found = list(columns.values()), np.ones(len(next(iter(columns.values()))), dtype=bool)
        for claim in self._claims:
            bound = getattr(claim, "bound", None)
            column = takers.get(parts_of(bound)) if isinstance(bound, str) else None
            if column is not None:
                found &= table[column] >= 0.0
            asked = set[str]()

            def read(name: str, asked: set[str] = asked) -> float:
                asked.add(name)
                return parameter_of(scene, name)

            claim.check_parameters(read)
            if any(parts_of(each) in takers for each in asked):
                for row in np.flatnonzero(found):
                    found[row] = allows(claim, scene, table, takers, int(row))
        return found

    def _reached(self, takers: Mapping[Variable, int], pruned: Pruned, stepping: Steps) -> set[str]:
        """The instances on which values that differ have an effect."""
        running, wires = pruned.scene.instances, pruned.scene.wires
        if stepping.size is not None:
            return set(running)
        sinks = sources_of((wire.sink[0], wire.source[0]) for wire in wires)
        return upstream({name for name, _variable in takers if name in running}, sinks)

    def _shown(
        self,
        scene: Scene,
        columns: Mapping[str, Floats],
        takers: Mapping[Variable, int],
        stepping: Steps,
        fastest: Floats,
    ) -> Mask:
        """The rows whose steps certainly show how the instances move."""
        movements, table = Movements(self._requested), list(columns.values())
        size = scene.step_size if stepping.size is None else stepping.size
        sizes = np.broadcast_to(size, len(fastest)) * (1.0 + ROUNDING)
        found = np.ones(len(fastest), dtype=bool)
        turns = [
            math.tau / (whole_turn(self._requested.unit(each)) or math.tau) for each in self._estimates.angles
        ]
        speeds = {
            each: fastest[:, place] * turns[place] * (1.0 + ROUNDING)
            for place, each in enumerate(self._estimates.angles)
        }
        for name, angles in self._estimates.moved.items():
            known = [speeds[each] for each in angles if each in speeds]
            speed = np.max(known, axis=0) if known else None
            if not reads(scene, name, takers):
                highest = None if speed is None else float(np.max(speed, initial=0.0))
                longest, _why = movements.longest_step(scene, name, highest)
                if np.all(sizes <= TOO_LONG * longest):
                    continue
            for row in np.flatnonzero(found):
                here = altered(scene, instances={name: with_row(scene, name, table, takers, int(row))})
                longest, _why = movements.longest_step(
                    here, name, None if speed is None else float(speed[row])
                )
                found[row] = sizes[row] <= TOO_LONG * longest
        return found

    def _near(self, scene: Scene, forms: Sequence[Sequence[Form]], verdicts: Floats) -> Mask:
        """The verdicts of each row that are near their bounds, as `Estimates.near` has them."""
        coarse, found = coarseness(scene), np.ones(verdicts.shape[:2], dtype=bool)
        for number, (asked, method) in enumerate(zip(forms, self._estimates.methods, strict=True)):
            bound, worst = verdicts[:, number, 3], verdicts[:, number, 4]
            for place, form in enumerate(asked):
                mine = verdicts[:, number, 2] == place
                named = form.signal in self._requested
                if (
                    named
                    and self._requested.scene.instances[parts_of(form.signal)[0]]
                    .fmu.ports[parts_of(form.signal)[1]]
                    .kind
                    == "Integer"
                ):
                    continue
                scale = np.maximum(
                    np.maximum(np.abs(bound), np.abs(worst)), usual(scene, form.signal, form.unit[0])
                )
                with np.errstate(invalid="ignore"):
                    far = np.abs(worst - bound) > coarse * method.near * scale
                found[:, number] &= ~(mine & far)
        return found
