"""A class from a Python file outside the package, checked before anything else is done with it."""

import ast
import inspect
import re
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from hashlib import sha256
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from ..components import COMPONENTS
from ..declaring.variables import Component
from ..errors import LoomfmuError, described, suggestion, within
from ..files import text_of
from . import declared

SPEC = re.compile(r"(?P<file>.+\.py)(?::(?P<name>[^:/\\]*))?")
Texts = dict[Path, str]


class Wanted(NamedTuple):
    """The kind of class that a file is to have: its base, its name in messages, what to do without one.

    `is_whole` tells those that are meant from those that they are built on, and `check` refuses a class that
    cannot be used, given the file as messages show it and its text.
    """

    base: type
    noun: str
    remedy: str
    is_whole: Callable[[Any], bool]
    check: Callable[[Any, Path, str], None]


# what a process has loaded: loaded again only if one of the texts has changed
_loaded: dict[tuple[Path, str, str], tuple[Any, Texts]] = {}


def is_file(spec: object) -> bool:
    """Return whether a class is named by its file, such as `cam.py` or `cam.py:PickingCam`."""
    return isinstance(spec, str) and SPEC.fullmatch(spec) is not None


def component(spec: str, directory: Path = Path()) -> type[Component]:
    """The component that `FILE.py` or `FILE.py:Class` names; the file is run.

    Raises LoomfmuError, naming file and line, for one that cannot be an FMU.
    """
    found: type[Component] = with_texts(spec, directory, COMPONENT)[0]
    return found


def texts(spec: str, directory: Path, wanted: Wanted) -> dict[str, str]:
    """The texts of a class's file and of the neighbours that it imports, by names from the directory."""
    base = (directory / split(spec)[0]).parent
    named = Path(split(spec)[0]).parent
    return {
        (named / path.relative_to(base.resolve())).as_posix(): text
        for path, text in with_texts(spec, directory, wanted)[1].items()
    }


def with_texts(spec: str, directory: Path, wanted: Wanted) -> tuple[Any, Texts]:
    """The class, and the texts of the files that it was made of."""
    file, name = split(spec)
    path = (directory / file).resolve()
    shown = directory / file
    known = _loaded.get((path, name, wanted.noun))
    if known is None or any(not each.is_file() or text_of(each) != text for each, text in known[1].items()):
        found, read = _executed(path, shown)
        chosen = _chosen(found, name, shown, wanted)
        wanted.check(chosen, shown, read[path])
        _loaded[path, name, wanted.noun] = known = chosen, read
    return known


def split(spec: str) -> tuple[str, str]:
    """Return the file and the class that a specification names, the class empty if it names none."""
    match = SPEC.fullmatch(spec)
    if match is None:
        raise LoomfmuError(f"{spec!r} is not a Python file such as cam.py or cam.py:PickingCam")
    return match["file"], match["name"] or ""


# ---- running the file


class _Neighbours(MetaPathFinder, Loader):
    """Finds the modules of one folder, compiles them from their text alone and keeps the texts.

    Python's own way would leave compiled files behind and take them for newer ones of the same second.
    """

    def __init__(self, path: Path):
        self.folder = path.parent
        self.texts: Texts = {}

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """A module of the folder, if there is one of that name."""
        file = self.folder / f"{fullname}.py"
        return spec_from_file_location(fullname, file, loader=self) if file.is_file() else None

    def exec_module(self, module: ModuleType) -> None:
        """Run the text of a module."""
        path = Path(str(module.__file__))
        self.texts[path] = text_of(path)
        exec(compile(self.texts[path], str(path), "exec"), module.__dict__)


def _executed(path: Path, shown: Path) -> tuple[ModuleType, Texts]:
    """The file's module, and the texts it came from. Raises LoomfmuError for what its code raises."""
    finder = _Neighbours(path)
    # the name belongs to this content alone: another file of this name is another module
    unique = f"{path.stem}_{sha256(f'{path}{text_of(shown)}'.encode()).hexdigest()[:12]}"
    spec = spec_from_file_location(unique, path, loader=finder)
    assert spec is not None, "a file that can be read has a specification"
    module = module_from_spec(spec)
    with _importing(finder, unique, module):
        try:
            finder.exec_module(module)
        except KeyboardInterrupt:
            raise
        except LoomfmuError:
            raise
        except SyntaxError as error:
            raise LoomfmuError(
                f"{_shown(Path(str(error.filename)), shown)}, line {error.lineno}: {error.msg}"
            ) from None
        except BaseException as error:  # whatever the file does when it is run
            raise failed(error, shown) from None
    return module, finder.texts


@contextmanager
def _importing(finder: _Neighbours, unique: str, module: ModuleType) -> Iterator[None]:
    """Let a module import its neighbours, which no other folder's modules of these names are taken for."""
    names = {file.stem for file in finder.folder.glob("*.py")}
    before = {name: sys.modules.pop(name) for name in names if name in sys.modules}
    sys.modules[unique] = module  # it stays: its classes are looked up there
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
        for name in names:
            sys.modules.pop(name, None)
        sys.modules.update(before)


def failed(error: BaseException, shown: Path) -> LoomfmuError:
    """Return the one line on an error of a file's code, with the line of the last step in its folder."""
    return LoomfmuError(f"{_place(error, shown)}: {described(error)}")


def _place(error: BaseException, shown: Path) -> str:
    folder = shown.resolve().parent
    steps = [
        step for step in traceback.extract_tb(error.__traceback__) if Path(step.filename).parent == folder
    ]
    return f"{_shown(Path(steps[-1].filename), shown)}, line {steps[-1].lineno}" if steps else str(shown)


def _shown(path: Path, shown: Path) -> Path:
    return shown.parent / path.name


# ---- the class


def _chosen(module: ModuleType, name: str, shown: Path, wanted: Wanted) -> Any:
    """The class of a module: the one of that name, or the only one."""
    found = {
        each.__name__: each
        for each in vars(module).values()
        if inspect.isclass(each) and issubclass(each, wanted.base) and each.__module__ == module.__name__
    }
    whole = {n: each for n, each in found.items() if wanted.is_whole(each)}
    if name:
        if name not in found:
            raise LoomfmuError(f"{shown}: it has no {wanted.noun} {name!r}{suggestion(name, found)}")
        return found[name]
    if not found:
        raise LoomfmuError(f"{shown}: it has no {wanted.noun}; {wanted.remedy}")
    candidates = whole or found
    if len(candidates) > 1:
        listed = ", ".join(f"{shown}:{each}" for each in candidates)
        raise LoomfmuError(f"{shown}: it has {len(candidates)} {wanted.noun}s; name one: {listed}")
    return next(iter(candidates.values()))


def _check(chosen: type[Component], shown: Path, text: str) -> None:
    """Refuse a component that cannot be an FMU, live and native."""
    fault = declared.fault(chosen, set(COMPONENTS))
    if fault is not None:
        raise LoomfmuError(f"{shown}, line {line(text, chosen.__name__, fault.field)}: {fault.text}")
    from ..fmi.native.translate import translate

    with within(shown):
        translate(chosen)


def line(text: str, name: str, field: str) -> int:
    """The line of a class that declares a field or a method, or else of the class itself."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ClassDef) and node.name == name:
            for inner in node.body:
                target = inner.target if isinstance(inner, ast.AnnAssign) else None
                targets = inner.targets if isinstance(inner, ast.Assign) else [target]
                names = [each.id for each in targets if isinstance(each, ast.Name)]
                if field in (*names, getattr(inner, "name", None)):
                    return inner.lineno
            return node.lineno
    return 1


COMPONENT = Wanted(
    Component,
    "component",
    "declare a class on ShaftDriven or Component of loomfmu.mechanism",
    lambda each: each.step is not Component.step,
    _check,
)
