"""What README and docs/ show is true: links lead somewhere, commands are understood, snippets run."""

import ast
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pytest
from environments import made, needed
from test_packages import pins
from write_fmu_pages import with_list

from loomfmu import cli
from loomfmu import commands as cli_commands
from loomfmu.components import COMPONENTS
from loomfmu.cosim.claims.claims import kinds
from loomfmu.cosim.scenes import scene
from loomfmu.declaring.variables import MIXED, OWN, PUBLISHED, variables_of
from loomfmu.fmi.fmu_files import folder
from loomfmu.sweeps import plan

HOUSE = Path(__file__).parents[1]
README = HOUSE / "README.md"
PAGES = [
    README,
    HOUSE / "CONTRIBUTING.md",
    HOUSE / "SECURITY.md",
    HOUSE / "fmus" / "README.md",
    *sorted((HOUSE / "docs").rglob("*.md")),
    *sorted((HOUSE / "fmus").glob("*/README.md")),
]
NAMES = [page.relative_to(HOUSE).as_posix() for page in PAGES]


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of a page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)


def prose(page: Path) -> str:
    """The text of a page in one line."""
    return in_one_line(page.read_text())


def in_one_line(text: str) -> str:
    """A text without its line breaks."""
    return " ".join(text.split())


def anchors(page: Path) -> set[str]:
    """The places of a page that a link can name, as GitHub makes them of its headings."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def commands(page: Path) -> list[list[str]]:
    """The arguments of each `loomfmu` command that a page shows in a block, fenced or indented."""
    fenced = re.findall(r"^(loomfmu .*)$", "".join(blocks(page, "sh")), re.MULTILINE)
    lines = [*fenced, *re.findall(r"^ {4}(loomfmu .*)$", page.read_text(), re.MULTILINE)]
    return [shlex.split(line, comments=True)[1:] for line in lines]


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_links_lead_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith(("http://", "https://")):
            continue
        name, _, anchor = target.partition("#")
        linked = (page.parent / name).resolve() if name else page
        assert linked.exists(), target
        assert not anchor or anchor in anchors(linked), target


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_commands_and_snippets_can_be_read(page: Path) -> None:
    for arguments in commands(page):
        cli_commands.parser().parse_args(arguments)  # exits where it does not understand
    for text in blocks(page, "python"):
        ast.parse(text)
    for text in blocks(page, "toml"):
        tomllib.loads(text)


def test_the_house_lists_what_is_there_and_the_layers_as_they_are_enforced() -> None:
    page = HOUSE / "docs" / "contributing" / "architecture.md"
    listed = set(re.findall(r"^      ([a-z_]+(?:\.py|/))", page.read_text(), re.MULTILINE))
    package = [path for path in (HOUSE / "src" / "loomfmu").iterdir() if path.name[0] not in "_."]
    there = {f"{path.name}/" if path.is_dir() else path.name for path in package}
    assert listed == there - {"py.typed"}
    rules = tomllib.loads((HOUSE / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    layers = [layer.replace("loomfmu.", "").replace(" | ", ", ") for layer in rules[0]["layers"]]
    assert " > ".join(layers) in prose(page)
    rooms = re.findall(r"^\| `(\w+)/` \| ([\d,]+) \|", page.read_text(), re.MULTILINE)
    assert len(rooms) > 8
    for room, lines in rooms:
        files = (HOUSE / "src" / "loomfmu" / room).rglob("*.py")
        found = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in files)
        assert int(lines.replace(",", "")) == pytest.approx(found, rel=0.1), room  # a page need not say more


def test_scenes_and_sweeps_that_are_shown_are_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["init", "--all"]) == 0
    for page in (README, HOUSE / "docs" / "scenes.md"):
        scene.parse(blocks(page, "toml")[0])
    Path("sweep.toml").write_text(blocks(HOUSE / "docs" / "sweeps.md", "toml")[0])
    assert plan.load("sweep.toml").title == "Safe speed by machine and wear"
    claims = blocks(HOUSE / "docs" / "claims.md", "toml")[0]
    demo = Path("wl680_3600.toml").read_text()
    assert len(scene.parse(f"{demo}\n{claims}").claims) == 8


@pytest.mark.no_cover
def test_the_readme_can_be_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmu_cache: None) -> None:
    monkeypatch.chdir(tmp_path)
    expected = {"shaft.speed=700rpm": 1, "belt.guide_clearance=0.5mm": 1}  # a claim fails there
    for arguments in commands(README):
        if arguments[0] in ("build", "export", "sweep", "optimize", "compare"):  # long, or of runs below
            continue
        status = next((code for value, code in expected.items() if value in arguments), 0)
        assert cli.main(arguments) == status, arguments
    Path("my_loom.toml").write_text(blocks(README, "toml")[0])
    assert cli.main(["run", "my_loom.toml"]) == 0
    assert cli.main(["run", "wl680_3600.toml"]) == 0
    (compared,) = [arguments for arguments in commands(README) if arguments[0] == "compare"]
    assert cli.main(compared) == 1
    shown: dict[str, Any] = {}
    for page in (README, HOUSE / "docs" / "python.md"):
        for text in blocks(page, "python"):
            exec(text, shown)
    assert f"{shown['loom'].safe_speed('WL680-3600', clearance='0.5 mm').speed:.2f}" == "63.47"
    assert f"{shown['loom'].clearance_for('650 rpm', 'WL680-3600'):.5f}" == "0.00038"


LONG = {
    "optimize",
    "prove",
    "--prove",
    "tolerances",
    "fit",
    "sweep",
}  # commands that take more than some seconds


def printing() -> Iterator[Any]:
    """Commands, the last of their block, with what a page says that they print."""
    shown = r"^```sh\n([^`]*)```\n\n(?:(?:(?!```).+\n)+\n)?```text\n([^`]*)^```$"
    for page, name in zip(PAGES, NAMES, strict=True):
        for command, text in re.findall(shown, page.read_text(), re.MULTILINE):
            program, *arguments = shlex.split(command.splitlines()[-1], comments=True)
            if program == "loomfmu" and name != "docs/own_claim.md":  # whose scene is on that page
                slow = [pytest.mark.slow] if LONG.intersection(arguments) else []
                yield pytest.param(arguments, text, id=f"{name} {arguments[0]}", marks=slow)


@pytest.mark.no_cover
@pytest.mark.parametrize(("arguments", "text"), list(printing()))
def test_commands_print_what_pages_show(
    arguments: list[str],
    text: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    fmu_cache: None,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    assert cli.main(["init", "--all"]) == 0
    shutil.copy(HOUSE / "docs" / "measured.csv", tmp_path)
    capsys.readouterr()
    assert cli.main(arguments) in (0, 1)
    said = in_one_line(capsys.readouterr().out)
    for part in re.split(r"^(?:\.\.\.|.* in total)$", text, flags=re.MULTILINE):  # times are others
        assert in_one_line(part) in said


@pytest.mark.slow
def test_the_long_commands_of_the_readme_can_be_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmu_cache: None
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["init"]) == 0 and cli.main(["new", "PickingCam"]) == 0
    long = [arguments for arguments in commands(README) if arguments[0] in ("build", "export", "sweep")]
    for arguments in long:
        # many looms of the sweep are too fast for their belt
        assert cli.main(arguments) == (arguments[0] == "sweep"), arguments
    assert len(list(Path("build/native").glob("*.fmu"))) == len(COMPONENTS) + 1
    assert {"loom.fmu", "loom.ssp"} <= {path.name for path in tmp_path.iterdir()}
    assert {"table.parquet", "map.png", "traces"} <= {
        path.name for path in Path("results/safe_speed").iterdir()
    }


# what the base install answers to the commands of the README that need an extra; fmpy brings that for reports
LACKING = {
    "build": "native",
    "export --fmu": "native",
    "sweep": "sweep,plot",
    "optimize": "study",
    "plot": "plot",
    "pytest": "No module named pytest",
}
MINUTES = 20.0  # that one command may take on a busy machine, without a compiler


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="environments are made of symbolic links")
@pytest.mark.parametrize("everything", [False, True], ids=["base", "demo"])
def test_the_readme_can_be_followed_in_an_environment_of_its_own(tmp_path: Path, everything: bool) -> None:
    names = set(pins("run.txt")) | {"loomfmu"} if everything else needed("loomfmu")
    python = made(tmp_path / "environment", names)
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "my_loom.toml").write_text(blocks(README, "toml")[0])
    environment = os.environ | {"LOOMFMU_CACHE": str(tmp_path / "cache"), "PYTHONPATH": ""}

    def outcome(*arguments: str) -> tuple[int, str]:
        done = subprocess.run(
            [python, *arguments],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=60.0 * MINUTES,
        )
        assert "Traceback" not in done.stderr and "a bug in loomfmu" not in done.stderr, done.stderr
        return done.returncode, (done.stderr.splitlines() or [""])[-1]

    assert outcome("-m", "loomfmu", "run", "my_loom.toml")[0] == 0
    for line in re.findall(r"^(?:loomfmu|pytest) .*$", "".join(blocks(README, "sh")), re.MULTILINE):
        arguments = shlex.split(line, comments=True)
        words = " ".join(arguments[1:] if arguments[0] == "loomfmu" else arguments)
        lacking = next((extras for start, extras in LACKING.items() if within(start, words)), "")
        status, said = outcome("-m", *arguments)
        if everything or not lacking:
            fails = ("shaft.speed=700rpm", "--set belt.guide_clearance", "sweep ", "compare ")
            assert status == any(each in words for each in fails), (line, said)
        else:
            assert status == (1 if lacking.startswith("No module") else 2), line
            assert said.endswith((f'pip install "loomfmu[{lacking}]"', lacking)), line
    for text in blocks(README, "python") if everything else ():
        assert outcome("-c", text)[0] == 0


def within(start: str, command: str) -> bool:
    """Whether a command has these words in this order."""
    words = iter(command.split())
    return all(word in words for word in start.split())


WORDS = {3: "three", 4: "four", 5: "five", 6: "six"}
LONG = (
    "report",
    "limits",
    "testing",
    "tolerances",
    "proving",
    "optimizing",
    "fitting",
)  # followed by the slow tests
FOLLOWED = ("tour", "scenes", "how_sure", "traces", "own_claim", *LONG)
NOT_RUN = {  # pages with commands or Python of which no test runs all, and why
    "importing": "other tools, which tests/foreign runs where they are installed",
    "sweeps": "its Python reads the results of a sweep that takes minutes",
}


def test_every_page_with_examples_is_followed_or_says_why_not() -> None:
    shown = {
        page.stem for page in (HOUSE / "docs").glob("*.md") if [*blocks(page, "sh"), *blocks(page, "python")]
    }
    assert shown == {*FOLLOWED, *NOT_RUN, "python"}  # that one with the README


@pytest.mark.no_cover
@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=pytest.mark.slow) if each in LONG else each for each in FOLLOWED]
)
def test_the_docs_can_be_followed(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmu_cache: None
) -> None:
    page = HOUSE / "docs" / f"{name}.md"
    monkeypatch.chdir(tmp_path)
    if name != "tour":  # which begins in an empty folder
        assert cli.main(["init", "--all"]) == 0
        assert cli.main(["run", "wl680_3600.toml"]) == 0
        Path("measured.csv").write_bytes((HOUSE / "docs" / "measured.csv").read_bytes())
        Path("expected.h5").write_bytes(Path("results/wl680_3600.h5").read_bytes())
    for text in (*blocks(page, "python"), *blocks(page, "toml")):
        if file := re.match(r"# (\w+\.(?:py|toml))\n", text):
            Path(file[1]).write_text(text)
    for line in re.findall(r"^loomfmu .*$", "".join(blocks(page, "sh")), re.MULTILINE):
        expected = int("# exit status 1" in line)
        assert cli.main(shlex.split(line, comments=True)[1:]) == expected, line
    if name == "tour":
        assert f"in {WORDS[len(commands(page))]} commands" in page.read_text()
        assert blocks(page, "toml")[0] in Path("wl680_3600.toml").read_text()
    shown: dict[str, Any] = {}
    for text in blocks(page, "python"):
        if "results/safe_speed" not in text:  # the traces of a sweep, which takes minutes
            exec(text, shown)


def test_the_list_of_fmus_is_up_to_date() -> None:
    page = (HOUSE / "fmus" / "README.md").read_text()
    assert re.findall(r"^\| `(\w+)` \|", page, re.M) == list(COMPONENTS)
    assert with_list(page) == page, "run `make docs`"


@pytest.mark.parametrize("name", COMPONENTS)
def test_a_page_claims_the_equations_that_its_component_declares(name: str) -> None:
    """Each line of equations with a number ends with its number in the source, or with "own"."""
    component = COMPONENTS[name]
    page = (folder(component) / "README.md").read_text()
    body = page.split("## Equations")[1].split("\n## ")[0]
    numbered = re.findall(r"^\(\w+\) .*$", "".join(re.findall(r"^```\n(.*?)^```$", body, re.S | re.M)), re.M)
    own = [line for line in numbered if re.search(r"\bown$", line)]
    if re.search(r"\bAll (?:equations )?are our own\b", " ".join(body.split())) or own == numbered:
        assert component.origin == OWN
    else:
        assert component.origin == (MIXED if own else PUBLISHED)


@pytest.mark.parametrize("name", COMPONENTS)
def test_values_that_a_page_calls_assumed_are_marked_so_where_they_are_declared(name: str) -> None:
    variables = {variable.name: variable for variable in variables_of(COMPONENTS[name])}
    page = (folder(COMPONENTS[name]) / "README.md").read_text()
    assumptions = page.split("## Assumptions")[1].split("\n## ")[0]
    named = re.findall(r"^\| `(\w+)`", assumptions, re.M)  # rows of a table, or "`name` = 1 ... assumed"
    named += re.findall(r"`(\w+)`(?: = [^`.]*)? (?:is|are) assumed", " ".join(assumptions.split()))
    for variable in (variables[each] for each in named):
        assert "assum" in variable.description, f"{name}.{variable.name}"


BENCHMARKS = (HOUSE / "results" / "benchmarks.md").read_text()


def test_the_readme_quotes_the_benchmarks() -> None:
    (row,) = re.findall(
        r"^\| a step, all outputs recorded \| (\w+) us \| .* \((\S+) us\) \|$", BENCHMARKS, re.M
    )
    ours, other = (round(float(each)) for each in row)
    (run,) = re.findall(r"^\| `loomfmu run`: .* \| (\w+) ms \|", BENCHMARKS, re.M)
    text = prose(README)
    assert f"all outputs recorded, takes {ours} us" in text
    assert f"the fastest other master that records takes {other} us" in text
    assert f"with native FMUs, {ours} us each; {int(run) / 1000.0:.2g} s in total" in text


def test_the_page_on_scenes_quotes_the_cost_of_isolation() -> None:
    rows = re.findall(r"^\| native \| \w+ \| [^|]+ \| [^|]+ \| (\S+) \|$", BENCHMARKS, re.M)
    low, high = sorted(round(float(each)) for each in rows)
    assert f"Isolation takes {low} to {high} us per step and FMU" in prose(HOUSE / "docs" / "scenes.md")


SOURCES = HOUSE / "docs" / "sources.md"


def of_package(name: str) -> object:
    """What a name stands for: a component, one of its variables, or something within `loomfmu`."""
    head, _, rest = name.partition(".")
    if head in COMPONENTS:
        known = {variable.name: variable for variable in variables_of(COMPONENTS[head])}
        return known[rest] if rest else COMPONENTS[head]
    return resolve_name(f"loomfmu.{name}")


def test_the_sources_page_names_what_there_is() -> None:
    cited = re.findall(r"`([^`]+)`", SOURCES.read_text())
    assert len(cited) > 100
    for name in dict.fromkeys(cited):
        if name.endswith(".csv"):
            assert (HOUSE / "src" / "loomfmu" / name).is_file(), name
        elif name != "loomfmu":
            assert name in kinds() or of_package(name), name


def test_the_sources_page_names_tables_of_the_validation() -> None:
    report = (HOUSE / "results" / "validation.md").read_text()
    headings = re.findall(r"^### (.*)$", report, re.MULTILINE)
    for row in re.findall(r"^\| (?!section|-).*$", SOURCES.read_text(), re.MULTILINE):
        section, _holds, _place, validation, _open = (cell.strip() for cell in row.strip("|").split("|"))
        for start in validation.split("; ") if validation != "-" else ():
            assert any(re.match(rf"{re.escape(start)}\b", heading) for heading in headings), (section, start)


def test_every_component_of_a_source_is_on_its_page() -> None:
    text = SOURCES.read_text()
    of_sources = [name for name, component in COMPONENTS.items() if component.origin != OWN]
    assert [name for name in of_sources if f"`{name}`" not in text] == []
