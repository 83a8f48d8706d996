"""Builds the documentation site in build/site, from the repository's pages and the code.

`make site` runs this.
"""

import os
import subprocess
import sys
from pathlib import Path

from website import assembly, contents

SOURCE = contents.ROOT / "build" / "site-source"


def build(source: Path = SOURCE, run_notebooks: bool = True) -> Path:
    """Assemble the site and have it built, warnings as errors; returns its folder, beside the source."""
    assembly.assemble(source, run_notebooks)
    subprocess.run(
        [
            sys.executable,
            "-m",
            "mkdocs",
            "build",
            "--quiet",
            "--strict",
            "--config-file",
            source / "mkdocs.yml",
        ],
        check=True,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},  # advice of the theme's makers on its successor
    )
    return source.parent / "site"


if __name__ == "__main__":
    print(build() / "index.html")
