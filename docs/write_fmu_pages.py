"""Writes what is generated in the folders of the FMUs: tables of variables in the READMEs, reference results.

A reference result is one default revolution of the FMU run alone. `make docs` runs this.
"""

from loomfmu.components import COMPONENTS
from loomfmu.fmi.builder import folder
from loomfmu.fmi.description import documentation
from loomfmu.variables import Component, variables_of

SAMPLES = 145  # 2.5 degrees of a revolution apart
STEP_SIZE = 60.0 / 400.0 / (SAMPLES - 1)  # at 400 rev/min, the speed by default


def write_readmes() -> None:
    """Bring the tables of variables in all READMEs up to date; a README that has none gets it at its end."""
    for component in COMPONENTS.values():
        readme = folder(component) / "README.md"
        text = documentation.with_table(readme.read_text(encoding="utf-8"), component)
        readme.write_text(text, encoding="utf-8")


def write_references() -> None:
    """Bring the reference results of all FMUs up to date."""
    for component in COMPONENTS.values():
        (folder(component) / "reference.csv").write_text(reference(component), encoding="utf-8")


def reference(component: type[Component]) -> str:
    """All outputs of a component over one revolution at its default values, booleans as 0 and 1.

    Raises ValueError where the component refuses its own defaults.
    """
    outputs = [variable for variable in variables_of(component) if variable.causality == "output"]
    lines = [",".join(["time", *(variable.name for variable in outputs)])]
    running = component()
    problem = running.initialize(0.0)
    for sample in range(SAMPLES):
        time = sample * STEP_SIZE
        if problem and not component.problems[problem - 1].warning:
            raise ValueError(f"{component.__name__} at {time!r} s: {component.problems[problem - 1].text}")
        values = [getattr(running, variable.name) for variable in outputs]
        lines.append(",".join(repr(int(v) if isinstance(v, bool) else v) for v in (time, *values)))
        problem = running.step(time, (sample + 1) * STEP_SIZE - time)
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    write_readmes()
    write_references()
