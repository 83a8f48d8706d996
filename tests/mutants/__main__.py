"""Mutants: one random change in the package at a time, to see whether the tests notice it.

    python tests/mutants --seed 25 --number 100 COPY

changes files of COPY, a clone that may be spoiled, and prints a line for each mutant. `tests.toml`
names the tests of a module, which come after its doctests; `--tests` takes those of another clone, and what
follows `--` goes to pytest.
"""

import argparse
import ast
import os
import random
import resource
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path

TABLE = tomllib.loads((Path(__file__).parent / "tests.toml").read_text())
PAIRS = [
    *[(ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Eq, ast.NotEq), (ast.Is, ast.IsNot), (ast.In, ast.NotIn)],
    *[(ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.And, ast.Or)],
]
OTHER = {one: other for pair in PAIRS for one, other in (pair, pair[::-1])}
CPU = 400  # s that the tests of a mutant may take: one that goes on for ever is noticed


def mutated(node: ast.AST) -> Iterator[ast.AST]:
    """The changes of one node."""
    new = deepcopy(node)
    match new:
        case ast.Compare(ops=[operator]) if type(operator) in OTHER:
            new.ops = [OTHER[type(operator)]()]
            yield new
        case ast.BinOp(op=operator) | ast.BoolOp(op=operator) if type(operator) in OTHER:
            new.op = OTHER[type(operator)]()
            yield new
        case ast.Constant(value=bool() | int() | float() as value):
            new.value = not value if isinstance(value, bool) else value + 1 if value in (0, 1) else value * 2
            yield new
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield new.operand
        case ast.IfExp() | ast.If() | ast.While():
            yield ast.UnaryOp(ast.Not(), new.test)
        case ast.Expr(value=ast.Call()) | ast.Assign(targets=[ast.Attribute()]) | ast.AugAssign():
            yield ast.Pass()


def mutants(text: str) -> Iterator[tuple[int, str, str, str]]:
    """Yield the line, the code before and after, and the whole text of each mutant."""
    whole = text.encode()
    lines = whole.splitlines(keepends=True)
    for node in ast.walk(ast.parse(text)):
        for new in mutated(node):
            old = node if isinstance(new, ast.Pass) else getattr(node, "test", node)
            start, end = (
                sum(map(len, lines[: line - 1])) + column
                for line, column in ((old.lineno, old.col_offset), (old.end_lineno, old.end_col_offset))
            )
            code = ast.unparse(new) if isinstance(new, ast.Pass) else f"({ast.unparse(new)})"
            changed = whole[:start] + code.encode() + whole[end:]
            yield old.lineno, whole[start:end].decode(), code, changed.decode()


def first_failure(copy: Path, tests: Path, module: str, options: list[str]) -> str:
    """Return the first test of a module that fails, an empty text if none does."""
    start = max((start for start in TABLE if module.startswith(start)), key=len)
    equations = module.startswith(("physics", "components"))
    # published numbers, and the variables as the pages of the FMUs state them, are compared in one place
    more = ["validation/test_report.py", "fmi/test_live_fmu.py"] if equations else []
    files = [str(copy / "src" / "loomfmu" / module), *(str(tests / file) for file in (*TABLE[start], *more))]
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *options, *files],
        cwd=tests.parent,
        env=os.environ | {"PYTHONPATH": str(copy / "src")},
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (CPU, CPU)),
    )
    failed = [
        line.split(" - ")[0] for line in run.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))
    ]
    return (failed or [f"exit status {run.returncode}"])[0] if run.returncode else ""


def main() -> None:
    """Try mutants one after the other."""
    parser = argparse.ArgumentParser(prog="mutants", description=__doc__)
    parser.add_argument("copy", type=Path)
    parser.add_argument("--seed", type=int, default=25)
    parser.add_argument("--number", type=int, default=100)
    parser.add_argument("--only", type=int, nargs="*", help="of these numbers")
    parser.add_argument("--tests", type=Path)
    parser.add_argument("pytest", nargs="*")
    given = parser.parse_args()
    copy = given.copy.resolve()
    tests, home = (given.tests or copy / "tests").resolve(), copy / "src" / "loomfmu"
    modules = {path: path.relative_to(home).as_posix() for path in sorted(home.rglob("*.py"))}
    files = [path for path, module in modules.items() if module.startswith(tuple(TABLE))]
    sites = [(path, place) for path in files for place, _ in enumerate(mutants(path.read_text()))]
    random.Random(given.seed).shuffle(sites)
    for number, (path, place) in enumerate(sites[: given.number]):
        if given.only and number not in given.only:
            continue
        text = path.read_text()
        line, before, after, changed = list(mutants(text))[place]
        try:
            path.write_text(changed)
            found = first_failure(copy, tests, modules[path], given.pytest)
        finally:
            path.write_text(text)
        print(
            number, modules[path], line, repr(before), repr(after), found or "survives", sep="\t", flush=True
        )


main()
