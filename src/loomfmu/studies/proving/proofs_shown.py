"""Proofs as people read them: a table, a sentence on what they mean, a picture of what is left open."""

import math
from typing import Any

import numpy as np

from ...display import printed
from ...display.printed import say
from ...errors import LoomfmuError
from ...sweeps.varied import labelled
from ...traces.plotting import COLOURS, HOLDS, HOLDS_LINE, figure, fixed_style
from .proofs import PROVEN, REFUTED, Proof, Proofs

HEADINGS = ("", "claim", "how")


def show(found: Proofs) -> None:
    """Print what was proven of every claim."""
    over = ", ".join(found.sides)
    duration, by_revolutions = f"{found.scene.extent:.15g}", found.scene.step is None
    duration += f" revolution{'s' * (found.scene.extent != 1)}" if by_revolutions else " s"
    say(
        f"{found.scene.title}: for all shaft angles of {duration}"
        + (f" and all values of {over}" if over else "")
    )
    table = [(proof.status, proof.claim, _how(proof)) for proof in found.claims]
    printed.show(HEADINGS, table, [(f"{status}  {claim}", f"({how})") for status, claim, how in table])
    if any(found.claims):
        say("proven are the equations as they are written, in real numbers; not that they describe the loom")


def show_unproven(found: Proofs) -> None:
    """Print each claim that was not proven, and why."""
    unproven = [f"  {proof.status}: {proof.claim} ({_how(proof)})" for proof in found.claims if not proof]
    if unproven:
        say(f"not proven for {' and '.join(found.sides)}:", *unproven)


def _how(proof: Proof) -> str:
    """Say by how many boxes a claim was proven, where it was refuted, or why it was not proven."""
    if proof.status == PROVEN:
        return f"by {proof.boxes} box{'es' * (proof.boxes != 1)}"
    if proof.status == REFUTED:
        return (
            ", ".join(f"{key} = {value}" for key, value in proof.witness.items()) or "at the scene's values"
        )
    if proof.boxes:
        return f"{proof.why}; {math.floor(1000.0 * proof.share) / 10.0:.1f} % of the box is proven"
    return proof.why


WIDTH, HEIGHT, REST = 8.0, 2.4, 0.9  # of each claim, and of the rest [in]


@fixed_style()
def draw(found: Proofs) -> Any:
    """A picture of what is proven, and what is not, over the shaft angle and the first value that varies.

    Raises LoomfmuError if no claim could be proven in part, or matplotlib is not installed.
    """
    claims = [each for each in found.claims if each.covers]
    if not claims:
        raise LoomfmuError("nothing is proven of any claim, so that there is nothing to draw")
    drawn = figure((WIDTH, HEIGHT * len(claims) + REST))
    for axes, claim in zip(drawn.subplots(len(claims), squeeze=False)[:, 0], claims, strict=True):
        _draw(axes, found, claim)
    drawn.suptitle(found.scene.title, fontsize=11)
    handles = drawn.axes[0].get_legend_handles_labels()
    drawn.legend(*handles, loc="outside lower center", ncols=2, frameon=False)
    return drawn


def _draw(axes: Any, found: Proofs, claim: Proof) -> None:
    """Draw the boxes of a claim that are left open, on all of them."""
    from matplotlib.collections import PolyCollection

    covers = [each for _condition, covers in claim.covers for each in covers]
    turn = math.radians(1.0) if claim.components else 1.0
    first = found.over[0] if found.over else None
    for colour, edge, label, boxes in (
        (HOLDS, HOLDS_LINE, "proven", [each.whole for each in covers]),
        (COLOURS[1], COLOURS[1], "left open", [box for each in covers for box in each.open]),
    ):
        corners = []
        for box in boxes:
            angles, *values = box if len(box) > len(found.over) else (np.array(claim.run), *box)
            left, right = angles / turn
            low, high = (0.0, 1.0) if first is None else values[0] / first.factor
            corners.append([(left, low), (right, low), (right, high), (left, high)])
        axes.add_collection(PolyCollection(corners, facecolors=colour, edgecolors=edge, label=label))
    axes.autoscale()
    axes.set_xlim(*(end / turn for end in claim.run))
    axes.set_title(claim.claim)
    axes.set_xlabel("shaft angle [deg]" if claim.components else "time [s]")
    if first is None:
        axes.set_yticks([])
    else:
        axes.set_ylabel(labelled(first.key, first.unit))
