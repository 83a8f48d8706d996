"""Damaged system packages and FMUs, and packages written to do harm."""

import random
import zipfile
from io import BytesIO
from pathlib import Path

import pytest
from foreign_motors import FIXED, FMI3, description2
from hostile import attacked, damaged, few_and_many, guarded, revalued

from loomfmu import LoomfmuError, files
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp import export as ssp
from loomfmu.cosim.ssp import package as packages
from loomfmu.cosim.ssp import read as ssp_read
from loomfmu.cosim.ssp.xml import NAMESPACES

SSD = "SystemStructure.ssd"
SPACES = " ".join(f'xmlns:{key}="{NAMESPACES[key]}"' for key in ("ssd", "ssc", "ssv", "ssm", "osp"))
LOOM = 'duration = "0.2 s"\nstep = "1 ms"\n[shaft]\n[weft]\nmachine = "WL680-3600"\n[belt]\n'


def zipped(members: dict[str, bytes], compression: int = zipfile.ZIP_DEFLATED) -> bytes:
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return buffer.getvalue()


@pytest.fixture(scope="module")
def loom(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The files of a package."""
    path = tmp_path_factory.mktemp("loom") / "loom.ssp"
    ssp.export(scenes.parse(LOOM, "loom"), path, "live")
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def foreign(loom: dict[str, bytes]) -> dict[str, bytes]:
    """The same package without the text of a scene, as another tool would write it."""
    text = loom[SSD].decode()
    start, end = text.index("<loomfmu:Scene"), text.index("</loomfmu:Scene>") + len("</loomfmu:Scene>")
    return loom | {SSD: (text[:start] + text[end:]).encode()}


@few_and_many
def test_damaged_packages_are_read_or_refused_in_one_line(
    tmp_path: Path, loom: dict[str, bytes], count: int
) -> None:
    texts = [name for name in loom if not name.endswith(".fmu")]
    bases = (loom, foreign(loom))

    def make(chance: random.Random, number: int) -> Path:
        members = dict(chance.choice(bases))
        for name in (SSD, chance.choice(texts)):
            if chance.random() < 0.4:
                members[name] = revalued(members[name].decode(errors="replace"), chance).encode()
            if chance.random() < 0.15:
                members[name] = damaged(members[name], chance)
        if chance.random() < 0.1:
            members[chance.choice(texts)] = members.pop(chance.choice(list(members)))
        whole = zipped(members, chance.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2)))
        path = tmp_path / f"{number % 4}.ssp"
        path.write_bytes(damaged(whole, chance) if chance.random() < 0.2 else whole)
        return path

    attacked("packages", make, ssp_read.load, count)


@few_and_many
def test_damaged_descriptions_of_fmus_are_read_or_refused_in_one_line(tmp_path: Path, count: int) -> None:
    texts = (description2(), FMI3.format(fixed=FIXED))

    def make(chance: random.Random, number: int) -> Path:
        text = chance.choice(texts)
        content = (revalued(text, chance) if chance.random() < 0.8 else text).encode()
        content = damaged(content, chance) if chance.random() < 0.5 else content
        whole = zipped({"modelDescription.xml": content})
        path = tmp_path / f"{number % 4}.fmu"
        path.write_bytes(damaged(whole, chance) if chance.random() < 0.2 else whole)
        return path

    attacked("descriptions of FMUs", make, fmus.load, count)


# ---- packages written to do harm


def refused(tmp_path: Path, members: dict[str, bytes] | bytes) -> str:
    path = tmp_path / "hostile.ssp"
    path.write_bytes(members if isinstance(members, bytes) else zipped(members))
    with pytest.raises(LoomfmuError) as raised, guarded():
        ssp_read.load(path)
    said = str(raised.value)
    assert said.isprintable() and said.startswith(f"{path}: ")
    return said.removeprefix(f"{path}: ")


def structure(elements: str, rest: str = "") -> bytes:
    return (
        f'<ssd:SystemStructureDescription version="1.0" name="n" {SPACES}><ssd:System name="s">'
        f"<ssd:Elements>{elements}</ssd:Elements>{rest}</ssd:System></ssd:SystemStructureDescription>"
    ).encode()


def test_a_zip_bomb_is_refused_before_it_is_unpacked(
    tmp_path: Path, loom: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "MOST_UNPACKED", 20_000_000)
    bomb = zipped(loom | {"resources/bomb": bytes(30_000_000)})
    assert len(bomb) < 1_000_000
    said = refused(tmp_path, bomb)
    assert said.startswith("cannot be read (it unpacks to 0.03") and said.endswith(" GB are unpacked)")
    (tmp_path / "bomb.fmu").write_bytes(bomb)
    with pytest.raises(LoomfmuError, match=r"bomb\.fmu: not a readable FMU \(it unpacks to 0\.03"):
        fmus.load(tmp_path / "bomb.fmu")


def test_a_stated_size_that_is_too_small_is_found_out(tmp_path: Path, loom: dict[str, bytes]) -> None:
    bomb = bytearray(zipped(loom | {SSD: bytes(30_000_000)}))
    real, stated = (30_000_000).to_bytes(4, "little"), (1000).to_bytes(4, "little")
    assert refused(tmp_path, bytes(bomb.replace(real, stated))) == (
        f"{SSD}: cannot be unpacked (Bad CRC-32 for file '{SSD}')"
    )


def test_the_number_of_files_and_their_names_are_limited(
    tmp_path: Path, loom: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert refused(tmp_path, loom | {"resources": b""}) == (
        "cannot be read ('resources' is both a file and a folder in it)"
    )
    with pytest.warns(UserWarning, match="Duplicate name"):
        buffer = BytesIO()
        with zipfile.ZipFile(buffer, "w") as archive:
            for content in (loom[SSD], loom[SSD] + b" "):
                archive.writestr(SSD, content)
    assert refused(tmp_path, buffer.getvalue()) == (
        f"cannot be read (it has two different files called '{SSD}')"
    )
    monkeypatch.setattr(files, "MOST_MEMBERS", 100)
    many = {f"resources/{number}": b"" for number in range(100)}
    assert refused(tmp_path, loom | many).startswith("cannot be read (it has 106 files; at most 100")


def test_an_xml_file_too_large_to_be_one_is_refused(
    tmp_path: Path, loom: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(packages, "LARGEST_XML", 2_000_000)
    assert refused(tmp_path, {SSD: bytes(3_000_000)}) == f"{SSD}: unpacks to 3 MB; at most 2 MB are read"


NESTED = '<ssd:System name="s"><ssd:Elements>' * 300 + "</ssd:Elements></ssd:System>" * 300
FACTOR = '<ssd:Units><ssc:Unit name="x"><ssc:BaseUnit factor="0"/></ssc:Unit></ssd:Units>'
HOSTILE = {
    "its systems are nested more than 50 deep": structure(NESTED),
    "not valid XML (multi-byte encodings are not supported": b'<?xml version="1.0" encoding="utf-7"?><a/>',
    "not valid XML (unknown encoding: x-klingon)": b'<?xml version="1.0" encoding="x-klingon"?><a/>',
    "not valid XML (limit on input amplification factor": b'<!DOCTYPE a [<!ENTITY b0 "bbbbbbbbbb">'
    + b"".join(b'<!ENTITY b%d "%s">' % (n, b"&b%d;" % (n - 1) * 10) for n in range(1, 10))
    + b"]><a>&b9;</a>",
    "there are two elements called 'x'": structure('<ssd:Component name="x" source="a"/>' * 2),
    "a unit has the factor 0 and the offset 0": structure("").replace(
        b"</ssd:SystemS", FACTOR.encode() + b"</ssd:SystemS"
    ),
    f"instance name '{'a' * 59}... has 200000 characters; at most 1000": structure(
        f'<ssd:Component name="{"a" * 200_000}" source="a"/>'
    ),
}


@pytest.mark.parametrize("said", HOSTILE)
def test_a_hostile_structure_is_refused_in_one_line(tmp_path: Path, said: str) -> None:
    assert said in refused(tmp_path, {SSD: HOSTILE[said]})


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "iso-8859-1"])
def test_a_structure_may_have_any_encoding_that_xml_has(
    tmp_path: Path, loom: dict[str, bytes], encoding: str
) -> None:
    text = foreign(loom)[SSD].decode().replace('name="loom"', 'name="F\u00e4den"')
    name = encoding.removesuffix("-sig")
    content = text.replace('encoding="UTF-8"', f'encoding="{name}"').encode(encoding)
    (tmp_path / "coded.ssp").write_bytes(zipped(foreign(loom) | {SSD: content}))
    scene = ssp_read.load(tmp_path / "coded.ssp", {"duration": "0.1 s", "step": "1 ms"})
    assert scene.title == "F\u00e4den" and "F\u00e4den" in scene.text and "\0" not in scene.text


DESCRIPTIONS = {
    "two variables are called 'J'": ('name="tau_stall"', 'name="J"'),
    "'J' has the value reference 4294967296, not a number of 32 bits": (
        'name="J" valueReference="0"',
        'name="J" valueReference="4294967296"',
    ),
    "'J' has the value reference -1, not a number": (
        'name="J" valueReference="0"',
        'name="J" valueReference="-1"',
    ),
    "2147483648 is outside of what an Integer holds": ("<Integer/>", '<Integer start="2147483648"/>'),
    "has 200000 characters, not 1 to 1000": ('name="load.tau"', f'name="{"a" * 200_000}"'),
    "a unit has the factor 0": ('factor="0.0174532925199433"', 'factor="0"'),
    "modelName has 200000 characters; at most 1000": ('modelName="Motor"', f'modelName="{"a" * 200_000}"'),
}


@pytest.mark.parametrize("said", DESCRIPTIONS)
def test_a_hostile_description_is_refused_in_one_line(tmp_path: Path, said: str) -> None:
    before, after = DESCRIPTIONS[said]
    text = description2()
    assert before in text
    path = tmp_path / "Motor.fmu"
    path.write_bytes(zipped({"modelDescription.xml": text.replace(before, after).encode()}))
    with pytest.raises(LoomfmuError) as raised, guarded():
        fmus.load(path)
    assert said in str(raised.value) and str(raised.value).isprintable()
