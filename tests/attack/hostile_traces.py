"""Hostile traces: a valid one that is changed, byte by byte or as somebody would who means harm."""

import json
import random
from collections.abc import Callable, Iterator

import h5py
import numpy as np


def flipped(content: bytes, dice: random.Random) -> bytes:
    """Some bits turned."""
    changed = bytearray(content)
    for _ in range(dice.choice((1, 4, 64))):
        changed[dice.randrange(len(changed))] ^= 1 << dice.randrange(8)
    return bytes(changed)


def overwritten(content: bytes, dice: random.Random) -> bytes:
    """A piece of zeros, of ones or of noise."""
    start, length = dice.randrange(len(content)), dice.choice((1, 8, 64, 4000))
    piece = dice.choice((bytes(length), b"\xff" * length, dice.randbytes(length)))
    return content[:start] + piece + content[start + length :]


def cut(content: bytes, dice: random.Random) -> bytes:
    """The end is missing, or a piece within."""
    start = dice.randrange(len(content))
    return content[:start] + content[start + dice.choice((1, 512, len(content))) :]


def moved(content: bytes, dice: random.Random) -> bytes:
    """A piece of it in another place."""
    source, target, length = (dice.randrange(n) for n in (len(content), len(content), 5000))
    return content[:target] + content[source : source + length] + content[target + length :]


def header(content: bytes, dice: random.Random) -> bytes:
    """Damage where HDF5 keeps what the file is made of, not in the samples."""
    head = flipped(content[:20_000], dice)
    return head + content[20_000:]


DAMAGES = (flipped, overwritten, cut, moved, header)


def damaged(content: bytes, seed: int) -> bytes:
    """One of the many ways."""
    dice = random.Random(seed)
    return dice.choice(DAMAGES)(content, dice)


def _claims(text: object) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        file.attrs["claims"] = text

    return change


def _instead(name: str, **what: object) -> Callable[[h5py.File], None]:
    """Another dataset under a name."""

    def change(file: h5py.File) -> None:
        del file[name]
        file.create_dataset(name, **what)

    return change


def _link(name: str, link: object) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        del file[name]
        file[name] = link

    return change


def _virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout((10,), "f8")
    layout[:] = h5py.VirtualSource("secret.h5", "secret", (10,))
    del file["belt/margin"]
    file.create_virtual_dataset("belt/margin", layout)


def _title(file: h5py.File) -> None:
    file.attrs.create("title", b"a loom \xff", dtype=h5py.string_dtype())


def _filtered(file: h5py.File) -> None:
    """A filter that HDF5 would look for among its plugins."""
    del file["belt/margin"]
    created = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    created.set_chunk((16,))
    created.set_filter(32001, h5py.h5z.FLAG_OPTIONAL, (1, 2, 3))
    space = h5py.h5s.create_simple((16,))
    h5py.h5d.create(file["belt"].id, b"margin", h5py.h5t.NATIVE_DOUBLE, space, created)


def crafted() -> Iterator[tuple[str, Callable[[h5py.File], None]]]:
    """Changes that need a file format's knowledge, with their names."""
    for name in ("belt/margin", "time"):
        yield f"{name} is a number", _instead(name, data=1.0)
        yield f"{name} is a table", _instead(name, data=np.zeros((3, 3)))
        yield f"{name} is empty", _instead(name, data=h5py.Empty("f8"))
        yield f"{name} is text", _instead(name, data=["a", "b"])
        yield f"{name} is huge", _instead(name, shape=(2**50,), dtype="f8", chunks=(4096,))
        yield f"{name} has huge chunks", _instead(name, shape=(2**28,), dtype="f8", chunks=(2**28,))
        yield (
            f"{name} is elsewhere",
            _instead(name, shape=(10,), dtype="f8", external=[("secret.h5", 0, 80)]),
        )
        yield f"{name} is linked", _link(name, h5py.ExternalLink("secret.h5", "/secret"))
        yield f"{name} is soft", _link(name, h5py.SoftLink("/shaft_angle"))
    packed = {"chunks": (4096,), "compression": "gzip", "compression_opts": 9, "shuffle": True}
    yield "time never goes on", _instead("time", data=np.zeros(4_000_000, "i1"), **packed)
    yield "the title is not text", _title
    yield "a group is linked", _link("belt", h5py.ExternalLink("secret.h5", "/"))
    yield "margin is virtual", _virtual
    yield "margin needs a plugin", _filtered
    for number, text in enumerate(("{", "[1]", "[{}]", '{"a": 1}', "[null]", "7", "[" * 100_000, "")):
        yield f"claims {number}", _claims(text)
    yield "claims are numbers", _claims(np.zeros((3, 3)))
    verdict = dict.fromkeys(("claim", "signal", "holds", "bound", "worst", "unit", "time", "angle"), "x")
    yield "claims of texts", _claims(json.dumps([verdict | {"revolution": 1}]))
