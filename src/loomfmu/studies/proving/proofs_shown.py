"""Proofs as people read them: a table, and what is proven of it in a sentence."""

from ...display import printed
from ...display.printed import say
from .proofs import PROVEN, REFUTED, Proof, Proofs

HEADINGS = ("", "claim", "how")


def show(found: Proofs) -> None:
    """Print what was proven of every claim."""
    over = ", ".join(f"{span.key} from {span.text}" for span in found.over)
    revolutions = f"{found.scene.periods:g} revolution{'s' * (found.scene.periods != 1)}"
    say(
        f"{found.scene.title}: for all shaft angles of {revolutions}"
        + (f" and all values of {over}" if over else "")
    )
    table = [(proof.status, proof.claim, _how(proof)) for proof in found.claims]
    printed.show(HEADINGS, table, [(f"{status}  {claim}", f"({how})") for status, claim, how in table])
    if any(found.claims):
        say("proven are the equations as they are written, in real numbers; not that they describe the loom")


def show_unproven(found: Proofs) -> None:
    """Print each claim that was not proven, and why."""
    over = " and ".join(f"{span.key} from {span.text}" for span in found.over)
    unproven = [f"  {proof.status}: {proof.claim} ({_how(proof)})" for proof in found.claims if not proof]
    if unproven:
        say(f"not proven for {over}:", *unproven)


def _how(proof: Proof) -> str:
    """Say by how many boxes a claim was proven, where it was refuted, or why it was not proven."""
    if proof.status == PROVEN:
        return f"by {proof.boxes} box{'es' * (proof.boxes != 1)}"
    if proof.status == REFUTED:
        return (
            ", ".join(f"{key} = {value}" for key, value in proof.witness.items()) or "at the scene's values"
        )
    if proof.boxes:
        return f"{proof.why}; {100 * proof.share:.1f} % of the box is proven"
    return proof.why
