"""C files that are compiled as they stand, each with the headers that it includes."""

import re
from pathlib import Path

_INCLUDED = re.compile(r'(?m)^#include "(?:[^"]*/)?([^"/]+)"')


def code_of(source: Path) -> dict[str, str]:
    """A C file and the headers that it includes, by their names, as if they lay in one folder."""
    text = source.read_text(encoding="utf-8")
    paths = re.findall(r'(?m)^#include "([^"]+)"', text)
    found = {source.name: _INCLUDED.sub(r'#include "\1"', text)}
    for path in paths:
        found |= code_of(source.parent / path)
    return found
