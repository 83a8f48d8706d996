"""What Python computes and C cannot, in a live FMU: one line that names the variable."""

from pathlib import Path

import pytest

import loomfmu
from loomfmu import LoomfmuError

ODD = '''"""A mechanism."""

from dataclasses import dataclass

from loomfmu.mechanism import Component, output, state


@dataclass(slots=True)
class Odd(Component):
    """A mechanism."""

    value: float = output("1", "Value")
    count: int = state("1", "Count", start=1)

    def initialize(self, time: float) -> int:
        """Begin."""
        self.count = 1
        {start}
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Go on."""
        self.value = 0.5 - time
        {step}
        return 0
'''
SCENE = 'duration = 2\nstep = 0.01\n[odd]\ncomponent = "odd.py"\n'


@pytest.mark.parametrize(
    ("start", "step", "text"),
    [
        (
            "pass",
            "self.value = self.value ** 0.5",
            "odd at 0.51 s: .*: value is complex: a negative number to",
        ),
        ("self.value = (self.value - 1.0) ** 0.5", "pass", "odd: value is complex: a negative number to"),
        # 2^63 is 9.22e18, and 3^40 = 1.2e19 is reached in the step that starts at 0.39 s
        ("pass", "self.count = self.count * 3", r"odd at 0.39 s: .*: count = 1.21\d+e\+19 exceeds a 64-bit"),
    ],
)
def test_it_is_rejected(tmp_path: Path, start: str, step: str, text: str) -> None:
    (tmp_path / "odd.py").write_text(ODD.format(start=start, step=step))
    (tmp_path / "odd.toml").write_text(SCENE)
    with pytest.raises(LoomfmuError, match=f"^{text}"):
        loomfmu.evaluate(tmp_path / "odd.toml", values=["odd.value"], flavour="live")
