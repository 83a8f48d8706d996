"""Components: their declared variables, problems and terminals, and the state between steps."""

import math
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, dataclass, fields, replace
from itertools import groupby
from typing import Any, ClassVar, NamedTuple

from .. import units
from ..errors import LoomfmuError, numbered, within
from .declarations import MAKERS

LARGEST_INTEGER = 2147483647  # of FMI 2
AT_STEP_END = "inputs_at_step_end"  # false where inputs are values at the start of the step


@dataclass(frozen=True)
class Variable:
    """One variable of a component, as it was declared. Bounds and the start value are SI."""

    name: str
    type: type
    causality: str
    variability: str
    unit: str
    """SI."""
    display: str
    """The unit that people read it in."""
    start: float | int | bool
    description: str
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    unbounded: bool = False
    rate: str | None = None
    """The variable that is its time derivative."""
    constant: bool = False
    """It follows from the parameters alone."""
    follows: str | None = None
    """The one input with which an output only rises or only falls."""
    choices: tuple[str, ...] = ()
    """Names of an enumeration's values, counted from 1."""
    indicator: bool = False
    """It changes its sign where an output jumps."""
    source: str | None = None
    """What gives an input, or a parameter without a value of its own, its value: `instance.variable`.

    # stands for the instance's own number, * in an array for all instances that have the variable. Several
    are separated by |: the first that the scene has counts.
    """
    source_for: str | None = None
    """The output taken, or the input wired to the same instance, without which `source` does not count."""
    lowest_of: str | None = None
    """The output whose lowest value so far it holds."""
    highest_of: str | None = None
    """The output whose highest value so far it holds."""
    so_far: bool = False
    """It only rises or only falls: a count, a sum, an extreme of something else."""
    when: str | None = None
    """The only parameter with which it has an effect: a Boolean, or an enumeration that starts with off."""
    unless: str | None = None
    """The parameter, of the same types, that takes its effect away."""
    brief: bool = False
    """It may leave its rest and come back within a step, unseen at both ends."""
    element: str = ""
    """Its place in an array, such as `table[35]` for `table_36`."""
    carried: bool = False
    """It holds what the outputs beside extremes follow from, from before the step."""
    valid_if: str | None = None
    """The Boolean output that tells when an output can be relied on."""
    error: str | None = None
    """The output, in the same unit, that tells how far this one may be off whatever the steps."""

    @property
    def member(self) -> str:
        """The name in the component's source and in its C."""
        return self.element or self.name

    @property
    def settable(self) -> bool:
        """Return whether a user or a master sets it."""
        return self.causality in ("parameter", "input")

    @property
    def one_way(self) -> bool:
        """True if it goes one way alone between two samples, so that these are its extremes."""
        held = self.so_far or self.lowest_of or self.highest_of
        return bool(held) or self.constant or self.variability == "fixed"

    @property
    def structured(self) -> str:
        """Its name in a model description, in which tools fold away rows and what is only kept inside.

        >>> from loomfmu.components import COMPONENTS
        >>> variables = {v.name: v for v in variables_of(COMPONENTS["DobbyDrive"])}
        >>> [variables[name].structured for name in ("law", "table_36", "cam_top", "cam_bend_1")]
        ['law', 'table[36]', 'internal.cam_top', 'internal.cam_bend[1]']
        """
        name = re.sub(r"_(\d+)$", r"[\1]", self.name)
        return f"internal.{name}" if self.causality == "local" else name

    @property
    def quantity(self) -> str:
        """The physical quantity by the unit; empty for plain numbers and for internal variables."""
        known = self.type is float and self.causality != "local"
        return units.QUANTITIES.get(self.unit, "") if known else ""

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest value inside an FMU: where none is declared, the largest of its type."""
        largest = LARGEST_INTEGER if self.type is int else sys.float_info.max
        low = -largest if self.minimum is None else self.minimum
        return low, largest if self.maximum is None else self.maximum

    def read(self, given: Any, name: str) -> float:
        """A quantity as people write it, in SI and within the limits; `name` is what a message calls it.

        Raises LoomfmuError for a quantity that this variable cannot have.
        """
        with within(name):
            value = units.parse(given, self.unit)
        complaint = replace(self, name=name).complaint(value)
        if complaint:
            raise LoomfmuError(complaint)
        return value

    @property
    def range(self) -> str:
        """Its limits in the unit people read it in, as messages show them."""
        low = -math.inf if self.minimum is None else self.minimum
        high = math.inf if self.maximum is None else self.maximum
        low, high = (bound / units.unit(self.display).factor for bound in (low, high))
        return f"[{low:.7g}, {high:.7g}]" + ("" if self.display == "1" else f" {self.display}")

    def complaint(self, value: float | int | bool) -> str:
        """Return the fault of a value, or an empty text."""
        low = -math.inf if self.minimum is None else self.minimum
        high = math.inf if self.maximum is None else self.maximum
        if low <= value <= high and math.isfinite(value):
            return ""
        if self.choices:
            return (
                f"{self.name} = {value:.7g} must be {numbered(self.choices, range(1, len(self.choices) + 1))}"
            )
        if not math.isfinite(value):
            return f"{self.name} = {value} is not a finite number"
        return f"{self.name} = {units.show(value, self.display)} is outside {self.range}"


@dataclass(frozen=True)
class Problem:
    """A problem that a component reports by its number, counted from 1.

    `text` may hold `{variable}` for the value of a variable. A warning is logged once and the run
    continues; anything else ends the step.
    """

    text: str
    warning: bool = False


# What a component carries from step to step, where its inputs hold at the step's end: nothing, so that its
# outputs are functions of time, parameters and inputs; nothing but extremes, so that all other outputs are;
# or its motion, which integrates over its inputs, with extremes or without.
TIME = "time"  # in the place of an input that an output depends on
SHARED = (TIME, "shaft_angle")  # what all recorded signals lie along: none of them has such a name
NOTHING, EXTREMES, MOTION = "nothing", "extremes", "motion"

# Whose equations a component has: those of a published source, some of them, or none
PUBLISHED, MIXED, OWN = "published", "published, with own parts", "own"


@dataclass(frozen=True)
class Terminal:
    """Variables that one connection wires; two terminals of one kind fit each other, member by member.

    The kind is what follows the last dot of the name, before which the instance of a whole system stands.
    `variables` are a component's own names for the `members`, in the same order.
    """

    name: str
    description: str
    members: tuple[str, ...]
    variables: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """The kind of terminal that it connects to."""
        return self.name.rpartition(".")[2]

    def of(self, *variables: str) -> "Terminal":
        """This terminal on a component that calls its members so."""
        return replace(self, variables=variables)


def variable_of(name: str, declared: Field[Any]) -> Variable:
    """The variable of a declaration. Raises TypeError for a field that is none."""
    start = declared.default
    if start is MISSING or "causality" not in declared.metadata:
        raise TypeError(f"{name} is not declared by {MAKERS}")
    return Variable(name=name, type=type(start), start=start, **declared.metadata)


@dataclass(slots=True)
class Component:
    """The base class of every component: declared variables, `initialize` and `step`.

    The methods of a component and the functions they call keep to the Python that also translates to
    C: floats, ints, bools, lists of fixed length and records, if, while and for-range, `math`, tuples for
    several results.
    """

    problems: ClassVar[tuple[Problem, ...]] = ()
    terminals: ClassVar[tuple[Terminal, ...]] = ()
    # whose equations it has
    origin: ClassVar[str] = OWN
    # what it carries from step to step; by default everything, so that every step counts
    keeps: ClassVar[str] = MOTION
    # how accurate its outputs are for given inputs, if it keeps a motion; they are exact to rounding if not
    accuracy: ClassVar[str] = ""
    # how much its outputs differ from step size to step size, however short the steps: a share of how far
    # they have moved since the start, unless an output says how far they may be off
    scatter: ClassVar[float] = 0.0
    # the output that counts contacts, where each makes a small difference larger
    bounces: ClassVar[str] = ""
    # outputs that are all positive where the extremes that it holds lie: the edges are where they change sign
    windows: ClassVar[tuple[str, ...]] = ()
    # the longest turn of the shaft [rad] whose ends show how its outputs change: inf for what is as smooth as
    # a published loom; where nothing is said, none is short enough, and every step of the scene counts
    longest_turn: ClassVar[float] = 0.0
    # of a shaft: the parameters that are 0 while it turns evenly; none of one that never does
    unsteady: ClassVar[tuple[str, ...]] = ()
    # what it keeps that drawings of it need: it is recorded only where a run is drawn, or where it is named
    drawn: ClassVar[tuple[str, ...]] = ()
    # the inputs that each output depends on, of a component whose source does not show them
    needs: ClassVar[Mapping[str, frozenset[str]]] = {}
    # and the inputs and parameters that it depends on at the start
    needs_at_start: ClassVar[Mapping[str, frozenset[str]]] = {}
    # whether a native FMU has derivatives of its outputs
    derivatives: ClassVar[bool] = True
    # end and communication step that a host starts from [s]
    experiment: ClassVar[tuple[float, float]] = (1.0, 1e-4)

    def __post_init__(self) -> None:
        for variable in variables_of(type(self)):
            complaint = variable.complaint(getattr(self, variable.name)) if variable.settable else ""
            if complaint:
                raise ValueError(f"{type(self).__name__}.{complaint}")

    @classmethod
    def declared(cls) -> tuple[Variable, ...]:
        """Its variables, in the order of their value references."""
        return tuple(variable_of(each.name, each) for each in fields(cls))

    @classmethod
    def longest_step(cls, value: Callable[[str], Any]) -> tuple[float, str]:
        """The longest step that shows how its outputs change with these parameters [s], and why."""
        return math.inf, ""

    @classmethod
    def shortest_event(cls, value: Callable[[str], Any]) -> tuple[float, str]:
        """The shaft angle of the shortest thing that it does with these parameters [rad], and its name."""
        return math.inf, ""

    def check(self) -> int:
        """The number of the first problem of the parameters, or 0."""
        return 0

    def initialize(self, time: float) -> int:
        """Compute what is computed once and the outputs at `time`; 0 or a problem's number."""
        raise NotImplementedError

    def step(self, time: float, step_size: float) -> int:
        """Go from `time` to `time + step_size`; 0 or a problem's number."""
        raise NotImplementedError


_variables: dict[type[Component], tuple[Variable, ...]] = {}


def variables_of(component: type[Component]) -> tuple[Variable, ...]:
    """All variables of a component in the order of their declaration; the index is the value reference."""
    if component not in _variables:
        _variables[component] = component.declared()
    return _variables[component]


class Beside(NamedTuple):
    """The outputs that say more of an output: when it is known, how far it is off, its extremes so far.

    An output that goes one way alone between two samples is its own `lowest` and `highest`.
    """

    valid_if: str | None = None
    error: str | None = None
    lowest: str | None = None
    highest: str | None = None


ALONE = Beside()


def beside(component: type[Component]) -> dict[str, Beside]:
    """The outputs that say more of each output of a component."""
    outputs = [variable for variable in variables_of(component) if variable.causality == "output"]
    reals = [variable for variable in outputs if variable.type is float]
    lowest = {each.lowest_of: each.name for each in reals}
    highest = {each.highest_of: each.name for each in reals}
    own = {each.name: each.name for each in outputs if each.one_way}
    return {
        each.name: Beside(
            each.valid_if, each.error, (own | lowest).get(each.name), (own | highest).get(each.name)
        )
        for each in outputs
    }


def arrays_of(component: type[Component]) -> dict[str, tuple[Variable, ...]]:
    """The arrays of a component, each with its variables."""
    elements = [variable for variable in variables_of(component) if variable.element]
    return {name: tuple(same) for name, same in groupby(elements, lambda v: v.element.partition("[")[0])}
