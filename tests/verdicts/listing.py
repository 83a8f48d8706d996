"""Wrong verdicts as scenes of their own, each with the command that shows it."""

from collections.abc import Sequence
from pathlib import Path

from verdicts.judging import CONFIRMED, Found, text_with


def listed(found: Sequence[Found], folder: Path) -> list[str]:
    """Write each wrong verdict on a scene, and each claim whose error is too small; a paragraph for each."""
    paragraphs, shown = [], set()
    for each in found:
        place = (each.scene.family, each.scene.number, str(each.claim.table), str(each.setting), each.wrong)
        if place not in shown and (each.wrong or (each.too_small and each.first)):
            shown.add(place)
            name = f"{each.scene.family}_{each.scene.number}_{len(shown)}.toml"
            paragraphs.append(_paragraph(each, folder / name))
    return paragraphs


def _paragraph(found: Found, path: Path) -> str:
    setting = "\n".join(
        f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value!r}"
        for key, value in found.setting.items()
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    text = text_with(found.scene, [found.stated])
    path.write_text(f"{setting}\n{text}", encoding="utf-8")
    verdict, truth = found.verdict, found.truth
    fault = f"wrong: {found.wrong}" if found.wrong else "error too small"
    finest = f"--set steps_per_revolution={CONFIRMED * found.scene.fine[-1]}"
    return (
        f"{found.scene.family} {found.scene.number}, {found.claim.label}: {fault}\n"
        f"  with {found.steps:g} steps in a revolution\n"
        f"  judged {verdict.worst!r}, error {verdict.error:.2g}, bound {verdict.bound!r} {verdict.unit}"
        f"{f' ({verdict.note})' if verdict.note else ''}\n"
        f"  truth {truth.value!r} to {truth.uncertainty:.1g}\n"
        f"  loomfmu run {path} --output build/verdicts/run.h5\n"
        f"  loomfmu run {path} --output build/verdicts/run.h5 {finest}"
    )
