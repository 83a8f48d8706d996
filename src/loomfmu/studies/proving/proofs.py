"""Proofs: of each claim its status, and what shows it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from ...cosim.claims.conditions import Condition
from ...cosim.scenes.scene import Scene
from ...declaring.variables import Component
from ...display import notebook
from ...errors import listed
from ..span import Span
from .cover import Cover

PROVEN, REFUTED, OPEN, IMPOSSIBLE = "proven", "refuted", "open", "cannot be proven"


@dataclass(frozen=True)
class Proof:
    """A claim, by its name and its number in the scene, over the box: its `status`, and why.

    A `share` of the box is proven, by so many `boxes`. A claim that is refuted has the values of a
    `witness`, at which its run fails.
    """

    claim: str
    number: int
    status: str
    why: str = ""
    share: float = 0.0
    boxes: int = 0
    witness: Mapping[str, str] = field(default_factory=dict)
    covers: tuple[tuple[Condition, tuple[Cover, ...]], ...] = field(default=(), repr=False)
    components: tuple[type[Component], ...] = field(default=(), repr=False)
    """Those of a proof that a certificate can confirm: over shaft angles, not over time."""
    run: tuple[float, float] = (0.0, 0.0)
    """The shaft angles [rad], or without components the times [s], from the start of the run to its end."""

    def __bool__(self) -> bool:
        return self.status == PROVEN


@dataclass(frozen=True, repr=False)
class Proofs:
    """The proofs of a scene `over` a box; true if all claims are proven."""

    scene: Scene
    over: tuple[Span, ...]
    claims: tuple[Proof, ...]
    warnings: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.claims) and all(self.claims)

    @property
    def sides(self) -> list[str]:
        """Return what varies and its range, in words."""
        return [f"{span.key} from {span.exact}" for span in self.over]  # beyond it may be false

    @property
    def remarks(self) -> dict[int, str]:
        """Return what to say of each claim that is proven, by its number in the scene."""
        text = f"proven for {listed(('all shaft angles', *self.sides))}"
        return {each.number: text for each in self.claims if each}

    @property
    def outside(self) -> str:
        """Return which value of the scene is not in its range, in words; an empty text if all are."""
        for span in self.over:
            for target in span.varied.targets:
                owner, _, variable = target.partition(".")
                value = float(self.scene.instances[owner].start(variable) or 0.0)
                if not span.low <= value <= span.high:
                    return f"{target} = {span.show(value)} is outside the range from {span.text}"
        return ""

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Return the ends of the box in SI, by what varies."""
        return {span.key: (span.low, span.high) for span in self.over}

    def __repr__(self) -> str:
        proven = f"{sum(map(bool, self.claims))} of {len(self.claims)} claims proven"
        others = "".join(f"\n  {each.status}: {each.claim}" for each in self.claims if not each)
        return notebook.warned(f"<Proofs of {self.scene.name}: {proven}{others}>", self.warnings)
