"""The files that all flavours of an FMU share: documents, licences, and the archive that holds them."""

import inspect
import io
import re
import textwrap
import uuid
import zipfile
from importlib import metadata
from pathlib import Path

import fmpy

from ..declaring.variables import Component
from ..files import check_target, zip_with
from ..version import __version__
from .description import documentation
from .description.parameter_sets import parameter_files, parameter_note
from .description.related_files import related_files
from .description.terminals import terminal_files

FMU = zip_with("an FMU of loomfmu", "modelDescription.xml", ".fmu")
TEXTS = {name: name for name in ("README.md", "drawing.svg", "icon.png", "reference.csv")}  # of a component
HEADERS = Path(fmpy.__file__).with_name("c-code")  # those of the standard
EARLIEST = (1980, 1, 1, 0, 0, 0)  # the first date a zip can hold: builds repeat
NAMESPACE = uuid.uuid5(uuid.NAMESPACE_URL, "https://pypi.org/project/loomfmu")


def folder(component: type[Component]) -> Path:
    """Return the folder with README, icon and reference of an FMU: that of its file, or the package's."""
    package = Path(__file__).parents[1]
    home = Path(inspect.getfile(component)).parent
    if not home.is_relative_to(package / "components"):
        return home
    name = re.sub(r"(?<!^)(?=[A-Z])", "_", component.__name__).lower()
    installed = package / "fmus" / name
    return installed if installed.is_dir() else package.parents[1] / "fmus" / name


def file_in(directory: Path, name: str, overwrite: bool) -> Path:
    """The file of an FMU in a directory. Raises LoomfmuError where it may not be written, before the work."""
    target = directory / f"{name}.fmu"
    check_target(target, FMU, overwrite=overwrite)
    return target


def zipped(contents: dict[str, bytes]) -> bytes:
    """Files by their names as a zip, the same bytes for the same files."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archived:
        for name, content in sorted(contents.items()):
            entry = zipfile.ZipInfo(name, EARLIEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archived.writestr(entry, content)
    return buffer.getvalue()


def described(component: type[Component], note: str = "") -> dict[str, bytes]:
    """The files that describe a component in every flavour; the note ends the documentation."""
    text = files_near(component, {"README.md": "text"}).get("text")
    readme = documentation.derived(component) if text is None else text.decode("utf-8-sig")
    readme = documentation.with_table(readme, component)
    note = documentation.names_note(component) + parameter_note(component) + note
    return {
        "documentation/index.html": documentation.page(component.__name__, readme + note),
        **files_near(component, {"drawing.svg": "documentation/drawing.svg"}),
        **related_files(component, files_near(component, {"reference.csv": "result"}).get("result")),
        **description_files(component),
    }


def files_near(component: type[Component], names: dict[str, str]) -> dict[str, bytes]:
    """Files that lie with a component, by their names in the FMU; those that are not there are left out."""
    home = folder(component)
    return {there: (home / here).read_bytes() for here, there in names.items() if (home / here).is_file()}


def description_files(component: type[Component]) -> dict[str, bytes]:
    """Return the files that describe the variables in addition to the model description."""
    return terminal_files(component) | parameter_files(component, __version__)


def license_of(distribution: str) -> bytes:
    """The licence text that a distribution carries, or that lies at the root of a checkout."""
    for file in metadata.files(distribution) or ():
        if "license" in file.name.lower():
            return Path(str(file.locate())).read_bytes()
    return (Path(__file__).parents[3] / "LICENSE").read_bytes()


def license_of_headers(header: str) -> bytes:
    """The licence of the standard's headers, which one of them states."""
    return textwrap.dedent(header[header.index("Copyright (C)") : header.index("*/")]).encode()
