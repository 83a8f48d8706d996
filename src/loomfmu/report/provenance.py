"""The provenance of the run: enough to judge it and to repeat it."""

from typing import Any

from .. import units
from ..traces import Trace
from .section import Section, Subject
from .templates import template

PLAIN = {
    "command": "Run by",
    "flavour": "FMUs",
    "revolutions": "Revolutions",
    "steps_per_revolution": "Communication steps per revolution",
    "duration": "Duration",
    "step": "Communication step",
    "ended_by": "Ended early by",
    "status": "Status",
    "software": "Software",
    "commit": "Commit",
}


def section(subject: Subject) -> Section:
    """Machine, values that differ from the scene, warnings, versions and hashes."""
    attributes, overrides = subject.trace.attributes, subject.trace.overrides
    facts = [
        (label, _shown(key, attributes[key]))
        for key, label in PLAIN.items()
        if attributes.get(key) not in (None, "")
    ]
    if units.is_plain(attributes.get("revolutions", "")):
        turned = subject.trace.turned_otherwise(float(attributes["revolutions"]))
        shown = {"Revolutions": f"{attributes['revolutions']} nominal; {turned}"} if turned else {}
        facts = [(label, shown.get(label, text)) for label, text in facts]
    facts.insert(1, ("Samples", f"{subject.trace.rows}"))
    return Section(
        "provenance",
        "The scene\u2019s own run" if subject.live else "The run",
        template("provenance.html.j2").render(
            live=subject.live,
            facts=facts,
            changed=[(key, _given(subject.trace, key, text)) for key, text in sorted(overrides.items())],
            notes=str(attributes.get("notes", "")).splitlines(),
            fmus=_fmus(attributes),
            scene=str(attributes.get("scene", "")),
        ),
    )


def _shown(key: str, value: Any) -> str:
    """A fact with its unit; traces of older versions have it in the text."""
    if not units.is_plain(value):
        return str(value)
    if key == "revolutions":
        return f"{float(value):g}"
    return f"{value} s" if key in ("duration", "step") else str(value)


def _given(trace: Trace, key: str, text: Any) -> str:
    """A value that was set, with its unit even if it was given without one."""
    return trace.parameter_text(key) if units.is_plain(text) and key in trace.parameters else str(text)


def _fmus(attributes: dict[str, Any]) -> list[tuple[str, str, str]]:
    """Name, version and SHA-256 of each FMU."""
    start, end = "fmu_", "_sha256"
    names = [key[len(start) : -len(end)] for key in attributes if key.startswith(start) and key.endswith(end)]
    return [
        (name, str(attributes.get(f"fmu_{name}_version", "")), str(attributes[f"fmu_{name}{end}"]))
        for name in sorted(names)
    ]
