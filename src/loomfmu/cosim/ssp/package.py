"""The files of a system package: read as they are needed, and only as far as memory and disk allow."""

import codecs
import hashlib
import posixpath
import re
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.etree.ElementTree import Element, ParseError, fromstring

from ...cache.entries import PACKAGES, folder
from ...errors import LoomfmuError, within
from ...files import check_archive, source

LARGEST_XML = 100_000_000  # bytes of one XML file


class Package:
    """A package that is open for reading."""

    def __init__(self, path: Path):
        self.path = path
        with source(path).open("rb") as file:
            self.sha256 = hashlib.file_digest(file, "sha256").hexdigest()
        with _reading("cannot be read"):
            self._archive = zipfile.ZipFile(path)
        self._members = check_archive(self._archive)
        self._inner: dict[str, Package] = {}

    def __enter__(self) -> "Package":
        return self

    def __exit__(self, *_: object) -> None:
        for inner in self._inner.values():
            inner.__exit__()
        self._archive.close()

    def opened(self, reference: str) -> "Package":
        """A package or an FMU in the package. Its files are known here as "its reference!/their own"."""
        if reference not in self._inner:
            self._inner[reference] = Package(self.unpacked(reference))
        return self._inner[reference]

    def root(self, reference: str) -> Element:
        """The root of an XML file of the package."""
        if inner := self._within(reference):
            with within(inner[0]):
                return inner[1].root(inner[2])
        name = self.member(reference)
        try:
            return fromstring(self._content(name))
        except (ParseError, LookupError, ValueError) as error:  # the latter for an unknown encoding
            raise LoomfmuError(f"{name}: not valid XML ({error})") from None

    def text(self, reference: str) -> str:
        """The text of an XML file of the package, in whatever encoding it says."""
        content = self._content(self.member(reference))
        marks = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
        marked = next((name for mark, name in marks.items() if content.startswith(mark)), "")
        stated = re.match(rb'<\?xml[^>]*encoding=["\']([\w.-]+)', content)
        encoding = marked or (stated[1].decode() if stated else "utf-8")
        return content.decode(encoding, errors="replace")

    def unpacked(self, reference: str) -> Path:
        """A file of the package, put where it can be read from."""
        if inner := self._within(reference):
            with within(inner[0]):
                return inner[1].unpacked(inner[2])
        name = self.member(reference)
        with _reading(f"{name}: cannot be unpacked"):
            content = self._archive.read(name)
        file = posixpath.basename(name)
        # an entry has exactly its files: under the content alone, two names would take it from each other
        key = hashlib.sha256(file.encode() + b"/" + content).hexdigest()
        return folder(PACKAGES, key, [file], lambda _: content) / file

    def member(self, reference: str) -> str:
        """The name of a file of the package, given as the structure refers to it."""
        name = posixpath.normpath(unquote(reference))
        outside = bool(urlsplit(reference).scheme) or name.startswith(("..", "/")) or "\\" in name
        if outside or name not in self._members:
            raise LoomfmuError(f"{reference or 'a parameter set'} is not in the package")
        return name

    def _within(self, reference: str) -> tuple[str, "Package", str] | None:
        """The package or FMU in this package that a reference leads into, and what that calls the file."""
        found = (name for name in self._inner if reference.startswith(f"{name}!/"))
        return next(((name, self._inner[name], reference[len(name) + 2 :]) for name in found), None)

    def _content(self, name: str) -> bytes:
        size = self._members[name].file_size
        if size > LARGEST_XML:
            raise LoomfmuError(
                f"{name}: unpacks to {size / 1e6:.0f} MB; at most {LARGEST_XML / 1e6:.0f} MB are read"
            )
        with _reading(f"{name}: cannot be unpacked"):
            return self._archive.read(name)


@contextmanager
def _reading(what: str) -> Iterator[None]:
    """One line for whatever zipfile, and the decompressors under it, raise for a damaged archive."""
    try:
        yield
    except OSError:
        raise
    except Exception as error:
        raise LoomfmuError(f"{what} ({error or type(error).__name__})") from None
