"""Weaves: which frames are raised at which pick, from strings of pegs or from WIF files.

WIF, the Weaving Information File (version 1.1, 1997), is the trade's own exchange format: an INI file
with the threading of the ends, and either a tie-up with a treadling or a lift plan.
"""

import configparser
import re
from dataclasses import dataclass
from pathlib import Path

from ...errors import LoomfmuError
from ...files import source

MOST_FRAMES = 20  # of the KRU-20 dobby
MOST_PICKS = 128  # that a heald frame's pattern holds


@dataclass(frozen=True)
class Weave:
    """A weave: for each frame its string of pegs, the first pick first, and the frame of each end."""

    pegs: tuple[str, ...]
    threading: tuple[int, ...] = ()

    @property
    def picks(self) -> int:
        """Picks after which the longest pattern repeats."""
        return max(len(pegs) for pegs in self.pegs)

    def ends_of(self, frame: int) -> int:
        """How many ends of a repeat of the threading a frame carries, frames counted from 1."""
        return self.threading.count(frame)


def parse(given: object, directory: Path) -> Weave:
    """A weave as a scene writes it: a list of pegs, pegs joined by `/`, or the name of a WIF file.

    Raises LoomfmuError for what is none, or is more than the dobby holds.

    >>> parse("10/01", Path()).pegs
    ('10', '01')
    """
    if is_wif(given):
        return read_wif(directory / str(given))
    pegs = given.split("/") if isinstance(given, str) else given
    if not isinstance(pegs, list) or not pegs:
        raise LoomfmuError(f'weave = {given!r} is neither pegs such as "10/01" nor the name of a WIF file')
    for number, frame in enumerate(pegs, start=1):
        check_pegs(frame, f"weave, frame {number}")
    return _within_the_dobby(Weave(tuple(pegs)), "weave")


def is_wif(given: object) -> bool:
    """Whether a weave as a scene writes it is the name of a WIF file."""
    return isinstance(given, str) and given.lower().endswith(".wif")


def check_pegs(pegs: object, where: str) -> str:
    """Pegs of one frame, checked: 1 raised, 0 lowered."""
    if not isinstance(pegs, str) or not re.fullmatch("[01]+", pegs):
        raise LoomfmuError(f'{where} = {pegs!r} is not a string of pegs such as "1010"')
    if len(pegs) > MOST_PICKS:
        raise LoomfmuError(f"{where} has {len(pegs)} picks; the dobby holds {MOST_PICKS}")
    return pegs


def _within_the_dobby(weave: Weave, where: str) -> Weave:
    if len(weave.pegs) > MOST_FRAMES:
        raise LoomfmuError(f"{where} has {len(weave.pegs)} frames; the dobby has {MOST_FRAMES}")
    if weave.picks > MOST_PICKS:
        raise LoomfmuError(f"{where} has {weave.picks} picks; the dobby holds {MOST_PICKS}")
    return weave


def read_wif(path: Path) -> Weave:
    """Read a WIF file. Raises LoomfmuError naming the file, the section and the key."""
    return of_wif(wif_text(path), path)


def wif_text(path: Path) -> str:
    """The text of a WIF file. Raises LoomfmuError where it cannot be read."""
    try:
        return source(path).read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise LoomfmuError(f"{path}: cannot be read ({error.strerror})") from None


def of_wif(text: str, path: Path) -> Weave:
    """The weave of a WIF file's text: lift plan if it has one, else tie-up and treadling.

    Raises LoomfmuError naming the file, the section and the key.
    """
    parser = configparser.ConfigParser(interpolation=None, strict=False)
    try:
        parser.read_string(text)
    except configparser.Error as error:
        raise LoomfmuError(f"{path}: not a WIF file ({str(error).splitlines()[0]})") from None
    sections = {name.upper(): dict(parser[name]) for name in parser.sections()}
    if "WIF" not in sections:
        raise LoomfmuError(f"{path}: not a WIF file (it has no section [WIF])")
    try:
        return _within_the_dobby(_weave(sections), str(path))
    except _WifError as error:
        raise LoomfmuError(f"{path}: {error}") from None


class _WifError(Exception):
    """What is wrong inside a WIF file."""


def _weave(sections: dict[str, dict[str, str]]) -> Weave:
    weaving = sections.get("WEAVING", {})
    frames = _count(weaving, "WEAVING", "shafts")
    picks = _count(sections.get("WEFT", {}), "WEFT", "threads")
    raised = _raised(sections)
    if weaving.get("rising shed", "true").strip().lower() in ("false", "no", "off", "0"):
        everything = set(range(1, frames + 1))
        raised = {pick: everything - raised.get(pick, set()) for pick in range(1, picks + 1)}
    highest = max((frame for frames_up in raised.values() for frame in frames_up), default=0)
    if highest > frames:
        raise _WifError(f"frame {highest} is raised, but [WEAVING] Shafts = {frames}")
    pegs = tuple(
        "".join("1" if frame in raised.get(pick, set()) else "0" for pick in range(1, picks + 1))
        for frame in range(1, frames + 1)
    )
    threading = _numbers(sections.get("THREADING", {}), "THREADING")
    ends = tuple(min(threading[end]) for end in sorted(threading) if threading[end])
    return Weave(pegs, ends)


def _raised(sections: dict[str, dict[str, str]]) -> dict[int, set[int]]:
    """Raised frames (of a rising shed: else the sunk ones) of each pick, counted from 1."""
    if "LIFTPLAN" in sections:
        return _numbers(sections["LIFTPLAN"], "LIFTPLAN")
    if "TIEUP" not in sections or "TREADLING" not in sections:
        raise _WifError("it has neither [LIFTPLAN] nor [TIEUP] with [TREADLING]")
    tie_up = _numbers(sections["TIEUP"], "TIEUP")
    treadling = _numbers(sections["TREADLING"], "TREADLING")
    return {
        pick: set().union(*(tie_up.get(treadle, set()) for treadle in treadles))
        for pick, treadles in treadling.items()
    }


def _numbers(section: dict[str, str], name: str) -> dict[int, set[int]]:
    """A section of lines `number=number,number`; 0 stands for none."""
    try:
        return {
            int(key): {int(part) for part in value.split(";")[0].split(",") if part.strip() and int(part) > 0}
            for key, value in section.items()
        }
    except ValueError:
        raise _WifError(f"[{name}] has a line that is not number=number,number") from None


def _count(section: dict[str, str], name: str, key: str) -> int:
    text = section.get(key, "")
    if not text.strip().isdigit() or int(text) == 0:
        raise _WifError(f"[{name}] {key.title()} = {text!r} is no number of 1 or more")
    return int(text)
