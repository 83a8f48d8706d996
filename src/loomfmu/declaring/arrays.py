"""Variables of a component that differ by their number, declared as one."""

from collections.abc import Iterable
from dataclasses import Field, field
from operator import attrgetter
from typing import Any


def array(declarations: Iterable[Any]) -> Any:
    """Variables of one type, declared as one field: `table` for `table_1`, `table_2` and so on.

    From outside each is a variable like any other, and the constructor takes it by its own name. Methods of
    the component read all of them as a tuple, so counted from 0, and set all of them at once:

    >>> from dataclasses import dataclass
    >>> from loomfmu.declaring.declarations import parameter
    >>> from loomfmu.declaring.variables import Component
    >>> @dataclass(slots=True)
    ... class Pegs(Component):
    ...     peg: tuple[int, ...] = array(parameter("1", start, "A peg") for start in (1, 0, 1))
    >>> Pegs(peg_3=7).peg
    (1, 0, 7)
    """
    return Array(declarations)


class Array:
    """The attribute of a component that stands for its variables of an `array`."""

    def __init__(self, declarations: Iterable[Field[Any]]):
        self.declared = tuple(declarations)
        if len(self.declared) < 2 or len({type(each.default) for each in self.declared}) > 1:
            raise TypeError("an array has two variables or more, all of one type")

    def __set_name__(self, owner: type, name: str) -> None:
        """Declare the variables in the place of the array, before `dataclass` reads what is declared."""
        self.names = tuple(f"{name}_{number + 1}" for number in range(len(self.declared)))
        self.read = attrgetter(*self.names)
        annotations = owner.__annotations__
        if self.names[0] in annotations:
            return  # the class that `dataclass` makes anew for its slots
        if name not in annotations:
            raise TypeError(f"an array needs its type: {name}: tuple[float, ...] = array(...)")
        owner.__annotations__ = {}
        for other, kind in annotations.items():
            owner.__annotations__ |= dict.fromkeys(self.names, kind) if other == name else {other: kind}
        for place, each in enumerate(self.declared):
            metadata = {**each.metadata, "element": f"{name}[{place}]"}
            setattr(owner, self.names[place], field(default=each.default, metadata=metadata))

    def __get__(self, component: Any, owner: type) -> Any:
        return self if component is None else self.read(component)

    def __set__(self, component: Any, values: Iterable[float]) -> None:
        for name, value in zip(self.names, values, strict=True):
            setattr(component, name, value)
