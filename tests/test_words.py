"""The words of the code: docstrings that say what a thing is or does."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

SOURCES = Path(__file__).parents[1] / "src" / "loomfmu"
# a docstring begins with a verb phrase ("Return the wires ...") or the name of the thing ("The wires ...")
QUESTION = re.compile(r"(How|That|What|When|Where|Whether|Which|Who|Why)\b")
DOCUMENTED = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def questions(path: Path) -> Iterator[str]:
    """Yield the first line of each docstring that begins with a question word, and its place."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, DOCUMENTED) and QUESTION.match(text := ast.get_docstring(node) or ""):
            yield f"{path.relative_to(SOURCES)}:{node.body[0].lineno}: {text.splitlines()[0]}"


def test_docstrings_begin_with_a_verb_or_with_the_thing_itself() -> None:
    found = [each for path in sorted(SOURCES.rglob("*.py")) for each in questions(path)]
    assert found == []
