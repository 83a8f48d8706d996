"""Weaves: which frames are raised at which pick, from strings of pegs or from WIF files.

WIF, the Weaving Information File (version 1.1, 1997), is the trade's own exchange format: an INI file
with the threading of the ends, and either a tie-up with a treadling or a lift plan.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path

from ..errors import LoomfmuError, shown, within
from ..files import source

MOST_FRAMES = 20  # of the KRU-20 dobby
MOST_PICKS = 128  # that a heald frame's pattern holds
MOST_BYTES = 4_000_000  # of a WIF file: thousands of ends and all their colours take a tenth
SECTIONS = ("WIF", "WEAVING", "WEFT", "THREADING", "LIFTPLAN", "TIEUP", "TREADLING")  # read
_WHOLE = re.compile(r"\s*-?[0-9]{1,9}\s*")


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
        """Return the number of ends of a threading repeat that a frame carries, frames counted from 1."""
        return self.threading.count(frame)


def parse(given: object, directory: Path) -> Weave:
    """A weave as a scene writes it: a list of pegs, pegs joined by `/`, or the name of a WIF file.

    Raises LoomfmuError for what is not a weave, or is more than the dobby holds.

    >>> parse("10/01", Path()).pegs
    ('10', '01')
    """
    if is_wif(given):
        return read_wif(directory / str(given))
    pegs = given.split("/") if given and isinstance(given, str) else given
    if not isinstance(pegs, list) or not pegs:
        raise LoomfmuError(
            f'weave = {shown(given)} is neither pegs such as "10/01" nor the name of a WIF file'
        )
    _check_frames(len(pegs), "weave")
    checked = tuple(check_pegs(frame, f"weave, frame {number}") for number, frame in enumerate(pegs, 1))
    longest = max(len(frame) for frame in checked)
    for number, frame in enumerate(checked, 1):
        if longest % len(frame):  # else it repeats within the longest
            raise LoomfmuError(
                f"weave, frame {number} has {len(frame)} picks and another frame {longest};"
                " write all frames with the same number of picks"
            )
    return Weave(checked)


def is_wif(given: object) -> bool:
    """Return whether a weave, as a scene writes it, is the name of a WIF file."""
    return isinstance(given, str) and given.lower().endswith(".wif")


def check_pegs(pegs: object, where: str) -> str:
    """Pegs of one frame, checked: 1 raised, 0 lowered."""
    if not isinstance(pegs, str) or not re.fullmatch("[01]+", pegs):
        raise LoomfmuError(f'{where} = {shown(pegs)} is not a string of pegs such as "1010"')
    _check_picks(len(pegs), where)
    return pegs


def _check_frames(frames: int, where: str) -> None:
    if frames > MOST_FRAMES:
        raise LoomfmuError(f"{where} has {frames} frames; the dobby has {MOST_FRAMES}")


def _check_picks(picks: int, where: str) -> None:
    if picks > MOST_PICKS:
        raise LoomfmuError(f"{where} has {picks} picks; the dobby holds {MOST_PICKS}")


def read_wif(path: Path) -> Weave:
    """Read a WIF file. Raises LoomfmuError naming the file, the section and the key."""
    return of_wif(wif_text(path), path)


def wif_text(path: Path) -> str:
    """The text of a WIF file. Raises LoomfmuError where it cannot be read."""
    try:
        with source(path).open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:  # a name with a NUL is a ValueError
        raise LoomfmuError(f"{path}: cannot be read ({getattr(error, 'strerror', error)})") from None
    if len(content) > MOST_BYTES:
        raise LoomfmuError(f"{path}: is larger than {MOST_BYTES // 1_000_000} MB, the most for a WIF file")
    return content.decode("utf-8-sig", errors="replace")


def of_wif(text: str, path: Path) -> Weave:
    """The weave of a WIF file's text, by its lift plan or its tie-up and treadling; both must agree.

    Raises LoomfmuError naming the file, the section and the key.
    """
    import configparser  # few scenes have such a file

    parts = re.split(r"(?m)^(?=\[)", text)
    wanted = [
        part for part in parts if part[1 : part.find("]")].upper() in SECTIONS
    ]  # others may be anything
    parser = configparser.ConfigParser(interpolation=None)
    try:
        parser.read_string("".join(wanted))
    except configparser.DuplicateOptionError as error:
        raise LoomfmuError(f"{path}: [{error.section}] has two lines {error.option}=") from None
    except configparser.DuplicateSectionError as error:
        raise LoomfmuError(f"{path}: has two sections [{error.section}]") from None
    except configparser.Error as error:
        raise LoomfmuError(f"{path}: not a WIF file ({str(error).splitlines()[0]})") from None
    sections = {name.upper(): dict(parser[name]) for name in parser.sections()}
    if "WIF" not in sections:
        raise LoomfmuError(f"{path}: not a WIF file (it has no section [WIF])")
    with within(path):
        return _weave(sections)


def _weave(sections: dict[str, dict[str, str]]) -> Weave:
    weaving = sections.get("WEAVING", {})
    frames = _count(weaving, "WEAVING", "shafts")
    picks = _count(sections.get("WEFT", {}), "WEFT", "threads")
    _check_frames(frames, "it")
    _check_picks(picks, "it")
    raised = _raised(sections, frames, picks)
    if not _rising(weaving):
        everything = set(range(1, frames + 1))
        raised = {pick: everything - up for pick, up in raised.items()}
    pegs = tuple(
        "".join("1" if frame in up else "0" for up in raised.values()) for frame in range(1, frames + 1)
    )
    threading = _numbers(sections, "THREADING", math.inf, frames)
    ends = tuple(min(threading[end]) for end in sorted(threading) if threading[end])
    return Weave(pegs, ends)


def _rising(weaving: dict[str, str]) -> bool:
    from configparser import ConfigParser

    given = weaving.get("rising shed", "true").split(";")[0].strip()
    if given.lower() not in ConfigParser.BOOLEAN_STATES:
        raise LoomfmuError(f"[WEAVING] Rising Shed = {shown(given)} is neither true nor false")
    return ConfigParser.BOOLEAN_STATES[given.lower()]


def _raised(sections: dict[str, dict[str, str]], frames: int, picks: int) -> dict[int, set[int]]:
    """Raised frames (of a rising shed: else the sunk ones) of each pick, counted from 1."""
    found = []
    if sections.get("LIFTPLAN"):
        found.append(_numbers(sections, "LIFTPLAN", picks, frames))
    if sections.get("TIEUP") and sections.get("TREADLING"):
        treadles = _count(sections.get("WEAVING", {}), "WEAVING", "treadles")
        tied = _numbers(sections, "TIEUP", treadles, frames)
        treadling = _numbers(sections, "TREADLING", picks, treadles).items()
        found.append(
            {pick: set().union(*(tied.get(each, ()) for each in trodden)) for pick, trodden in treadling}
        )
    if not found:
        raise LoomfmuError("it has neither [LIFTPLAN] nor [TIEUP] with [TREADLING]")
    raised, *others = ({pick: each.get(pick, set()) for pick in range(1, picks + 1)} for each in found)
    for pick in raised:
        if any(each[pick] != raised[pick] for each in others):
            raise LoomfmuError(f"[LIFTPLAN] and [TREADLING] raise different frames at pick {pick}")
    return raised


def _numbers(sections: dict[str, dict[str, str]], name: str, lines: float, most: int) -> dict[int, set[int]]:
    """A section of lines `number=number,number`, counted from 1 to the given ones; 0 stands for none."""
    found = dict[int, set[int]]()
    for key, text in sections.get(name, {}).items():
        try:
            parts = filter(str.strip, text.split(";")[0].split(","))
            place, values = _whole(key), set(map(_whole, parts))
        except ValueError:
            raise LoomfmuError(f"[{name}] has a line that is not number=number,number") from None
        limits = (place, 1, lines), *((value, 0, most) for value in values)
        for number, least, highest in limits:
            if not least <= number <= highest:
                raise LoomfmuError(
                    f"[{name}] has a line {key}={text}, but {number} is not in {least} to {highest}"
                )
        found[place] = values - {0}
    return found


def _count(section: dict[str, str], name: str, key: str) -> int:
    text = section.get(key, "")
    try:
        count = _whole(text)
    except ValueError:
        count = 0
    if count < 1:
        raise LoomfmuError(f"[{name}] {key.title()} = {shown(text)} is not a whole number of 1 or more")
    return count


def _whole(text: str) -> int:
    """A whole number in plain digits. Raises ValueError for anything else, also what `int` would read."""
    if not _WHOLE.fullmatch(text):
        raise ValueError
    return int(text)
