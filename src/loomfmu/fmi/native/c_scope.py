"""The meaning of names in a function, and the structs that C needs to know for it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from .c_code import Array, Declared, Kind, Record, Results, Signature, c_name, short
from .c_numbers import PLAIN, Numbers


@dataclass
class Scope:
    """Meaning of the names in a function: its locals, the component's variables, functions and constants."""

    component: str
    functions: dict[str, Declared]
    methods: dict[str, Declared]
    records: dict[str, dict[str, str]]  # the fields of each, with their annotations
    variables: dict[str, str]  # of the component, as C calls them, with their types
    arrays: dict[str, tuple[str, ...]]  # of the component, with the names of their elements
    constants: dict[str, float | int]
    tables: dict[str, tuple[float | int, ...]]  # constants that are several numbers
    from_math: frozenset[str]
    changes: dict[str, frozenset[str]]  # the variables that each method changes, those that it calls included
    numbers: Numbers = PLAIN
    structs: dict[str, str] = field(
        default_factory=dict
    )  # declarations of structs and tables, in their order
    locals: dict[str, Kind] = field(default_factory=dict)
    # translates a function for arguments of these types, unless it is already
    translated: Callable[[Declared, tuple[Kind, ...]], Signature] = lambda declared, kinds: Signature(
        "", (), ()
    )
    lent: frozenset[str] = frozenset()  # arguments that are pointers
    renamed: dict[str, str] = field(default_factory=dict)  # the variable of a comprehension
    spans: dict[str, tuple[int, int]] = field(
        default_factory=dict
    )  # first and last value of a loop's variable

    def array(self, element: str, size: int) -> Array:
        """The type of an array, declared in C."""
        kind = Array(self.component, element, size)
        self.structs[str(kind)] = f"{kind} {{ {self.numbers.text(element)} at[{size}]; }};"
        return kind

    def record(self, name: str, kinds: Iterable[Kind]) -> Record:
        """The type of a record with fields of these types, declared in C."""
        kind = Record(self.component, name, tuple(zip(self.records[name], kinds, strict=True)))
        members = " ".join(f"{self.numbers.text(each)} {c_name(field)};" for field, each in kind.fields)
        self.structs[str(kind)] = f"{kind} {{ {members} }};"
        return kind

    def returned(self, results: Results) -> str:
        """The C type of what a function returns; several values come in a struct, declared in C."""
        if len(results) < 2:
            return self.numbers.text(results[0]) if results else "void"
        name = f"struct {self.component}_{''.join(map(short, results))}"
        members = " ".join(f"{self.numbers.text(kind)} value_{place};" for place, kind in enumerate(results))
        self.structs[name] = f"{name} {{ {members} }};"
        return name
