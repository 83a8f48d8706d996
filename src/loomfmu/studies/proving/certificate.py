"""Certificates: what others need to confirm a proof, without the prover and without trust in it."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...cosim.claims.conditions import Condition, Sometime
from ...errors import LoomfmuError
from ...files import starts_with, write_file
from ...fmi import source
from . import FORMAT, MOST_REVOLUTIONS
from .cover import Cover
from .proofs import Proofs

CERTIFICATE = starts_with("a certificate of a proof", b'{"format": "loomfmu proof', suffix=".json")


def write(proofs: Proofs, path: Path, inputs: Sequence[Path] = (), overwrite: bool = False) -> list[str]:
    """Write a certificate of the claims that are proven at every angle, and return their names.

    Proofs over time have none. Raises LoomfmuError if there is none to certify.
    """
    names = [proof.claim for proof in proofs.claims]
    certified = [each for each in proofs.claims if each and each.components and names.count(each.claim) == 1]
    if not certified or proofs.scene.extent > MOST_REVOLUTIONS:
        raise LoomfmuError(f"{path} is not written: no claim that a certificate can confirm is proven")
    scene = proofs.scene
    told: dict[str, Any] = {
        "format": FORMAT,
        "name": scene.name,
        "scene": scene.text,
        "texts": scene.texts,
        "overrides": scene.overrides,
        "over": {span.key: [span.low.hex(), span.high.hex()] for span in proofs.over},
        "equations": {
            component.__name__: source.digest(component)
            for proof in certified
            for component in proof.components
        },
        "claims": [
            {
                "name": proof.claim,
                "conditions": [
                    [_told(condition, cover) for cover in covers] for condition, covers in proof.covers
                ],
            }
            for proof in certified
        ],
    }
    write_file(path, json.dumps(told).encode(), CERTIFICATE, inputs, overwrite)
    return [proof.claim for proof in certified]


def _told(condition: Condition, cover: Cover) -> list[Any]:
    """Return a cover for JSON. Where one angle is enough, that angle comes first."""
    return [float(cover.whole[0, 0]).hex(), *cover.tree] if isinstance(condition, Sometime) else cover.tree
