"""C files that are compiled as they stand, each with the headers beside it."""

from pathlib import Path


def code_of(source: Path) -> dict[str, str]:
    """A C file and the headers beside it, by their names."""
    files = [source, *sorted(source.parent.glob("*.h"))]
    return {file.name: file.read_text(encoding="utf-8") for file in files}
