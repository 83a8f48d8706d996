"""Scenes as tests: `pytest sims/wl680_3600.toml` has one test for each claim.

pytest loads this in every run, so nothing of loomfmu is imported before there is a scene to collect.
"""

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from .cosim.results import Evaluation, Result
    from .cosim.scenes.scene import Scene
    from .traces import Verdict

SCENES = "loomfmu_scenes"
TRACES = "--loomfmu-traces"
TABLES = {"loom", "claims"}  # a scene has one of them; other TOML files are left alone


def pytest_addoption(parser: pytest.Parser) -> None:
    """The options."""
    parser.getgroup("loomfmu", "scenes of loomfmu").addoption(
        TRACES, metavar="DIR", help="keep a trace of each scene that is tested, and a report if a claim fails"
    )
    parser.addini(
        SCENES,
        "Scenes of loomfmu to collect, such as sims/*.toml, beside those on the command line",
        type="args",
        default=[],
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "SceneFile | None":
    """A scene that was named, or that the configuration matches."""
    if file_path.suffix != ".toml":
        return None
    named = parent.session.isinitpath(file_path)
    if not (named or file_path in _matched(parent.config)) or not _is_scene(file_path):
        return None
    return SceneFile.from_parent(parent, path=file_path)


_MATCHED = pytest.StashKey[set[Path]]()


def _matched(config: pytest.Config) -> set[Path]:
    """The files that the configuration matches, below its folder."""
    if _MATCHED not in config.stash:
        patterns = config.getini(SCENES)
        config.stash[_MATCHED] = {path for pattern in patterns for path in config.rootpath.glob(pattern)}
    return config.stash[_MATCHED]


def _is_scene(path: Path) -> bool:
    """Return whether a TOML file is a scene; an invalid one may be meant as one."""
    import tomllib

    try:
        return bool(TABLES & set(tomllib.loads(path.read_text(encoding="utf-8-sig"))))
    except (OSError, RecursionError, ValueError):
        return True


class SceneFile(pytest.File):
    """A scene: its claims are tests. It runs once, for the first of them."""

    def collect(self) -> Iterator["ClaimItem"]:
        """One test for each claim; a scene without claims has one that it runs."""
        from .errors import LoomfmuError

        try:
            claims = self.scene.claims
        except LoomfmuError as error:
            raise self.CollectError(str(error)) from None
        for number, name in enumerate(_names(claims)):
            yield ClaimItem.from_parent(self, name=name, number=number)

    @cached_property
    def scene(self) -> "Scene":
        """The scene, read and checked. Raises LoomfmuError."""
        from .cosim.reading import checked, protected

        return protected(checked(_relative(self.path), None, "native"))

    @cached_property
    def outcome(self) -> "Evaluation | Result | Exception":
        """The run, or why there is none."""
        from .cosim.run import evaluate, run
        from .errors import LoomfmuError

        try:
            return (
                evaluate(self.scene) if self.trace_path is None else run(self.scene, output=self.trace_path)
            )
        except LoomfmuError as error:
            return error

    @property
    def trace_path(self) -> Path | None:
        """Return the path at which to keep the trace, in the same subfolders as the scene."""
        directory = self.config.getoption(TRACES)
        if directory is None:
            return None
        root = self.config.rootpath
        below = self.path.relative_to(root) if self.path.is_relative_to(root) else Path(self.path.name)
        return Path(directory) / below.with_suffix(".h5")

    @cached_property
    def outputs(self) -> list[str]:
        """Return the files of a run that failed: its trace, and its report if that can be written."""
        from .cosim.results import Result
        from .errors import LoomfmuError
        from .report import write
        from .traces import Trace

        if not isinstance(self.outcome, Result):
            return [f"to see it:    {self._command('--report')}"]
        lines = [f"trace:        {self.outcome.path}"]
        try:
            with Trace(self.outcome.path) as trace:  # that of another worker, if it ran the scene, too
                return [*lines, f"report:       {_relative(write([trace]))}"]
        except LoomfmuError as error:
            return [*lines, f"no report:    {error}"]

    def failure(self, verdict: "Verdict") -> str:
        """Return the facts that an engineer needs about a claim that failed."""
        warnings = [f"warning:      {text}" for text in getattr(self.outcome, "warnings", ())]
        facts = {
            "signal": verdict.signal,
            "worst": verdict.shown_worst,
            "bound": ("at least " if verdict.sense > 0 else "at most ") + verdict.shown(verdict.bound),
            "distance": verdict.known(verdict.distance),
            "error": verdict.shown_error,
            "at": verdict.place or "no place",
            "note": verdict.note,
            "to reproduce": self._command(),
        }
        lines = [f"{f'{name}:':13} {value}" for name, value in facts.items() if value]
        outcome = "claim fails:" if verdict.decided else "undecided:"
        return "\n".join([f"{outcome:13} {verdict.claim}", *lines, *self.outputs, *warnings])

    def _command(self, *options: str) -> str:
        import shlex

        return shlex.join(["loomfmu", "run", str(_relative(self.path)), *options])


class ClaimFailed(Exception):
    """A claim that fails; the text says all about it."""


class ClaimItem(pytest.Item):
    """The test of a claim."""

    parent: SceneFile

    def __init__(self, *, number: int, **named: Any) -> None:
        super().__init__(**named)
        self.number = number

    def runtest(self) -> None:
        """Run the scene, unless a claim before this one has, and fail if the claim does."""
        outcome = self.parent.outcome
        if isinstance(outcome, Exception):
            raise outcome
        if not outcome.claims:
            outcome.check_end()
        elif not outcome.claims[self.number]:
            raise ClaimFailed(self.parent.failure(outcome.claims[self.number]))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The message alone for what is not a fault of the code."""
        from .errors import LoomfmuError

        if isinstance(excinfo.value, ClaimFailed | LoomfmuError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """Return the file of the test, and its name."""
        return self.path, None, f"{self.path.name}: {self.name}"


def _relative(path: Path) -> Path:
    """The path as it is typed here."""
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path


def _names(claims: list[dict[str, Any]]) -> list[str]:
    """A name for the test of each claim: its own or its kind, with a number where there are several."""
    from .cosim.claims.claims import name_of
    from .display.printed import safe

    names: list[str] = []
    for claim in claims:
        base = safe(name_of(claim)).replace("::", ":")
        number, name = 1, base
        while name in names:
            number, name = number + 1, f"{base} ({number + 1})"
        names.append(name)
    return names or ["runs"]
