"""Claims on expressions in studies: proofs, limits and derivatives are those of the closed form."""

import math

import pytest
from scene_texts import claim, loom, table

import loomfmu
from loomfmu.cosim.scenes.scene import Scene, parse

TEXT = "revolutions = 2\nsteps_per_revolution = 720\n" + loom(
    'weave = "10/01"\n', table("shaft", speed="600 rev/min")
)


def scene(*claims: tuple[str, str, str, str]) -> Scene:
    tables = (claim(kind, name=name, signal=signal, bound=bound) for name, kind, signal, bound in claims)
    return parse(TEXT + "".join(tables), "loom")


def test_sums_and_their_cases_are_proven_and_nothing_else_is() -> None:
    found = loomfmu.prove(
        scene(
            ("meet", "below", "abs(heald_1.lift + heald_2.lift - 98 mm)", "0.1 mm"),
            ("apart", "below", "heald_1.lift / 2 - 0.5 * heald_2.lift", "49.1 mm"),
            ("too near", "above", "min(heald_1.lift, heald_2.lift) - 1 mm", "0 mm"),
            ("product", "below", "heald_1.lift * heald_2.lift / (1 mm)", "9 m"),
        )
    )
    assert [each.status for each in found.claims] == ["proven", "proven", "refuted", "cannot be proven"]
    assert found.claims[-1].why == "it is on an expression that is not a sum of shares of signals"


def test_the_limit_of_an_expression_is_that_of_the_closed_form() -> None:
    share = ("share", "above", "heald_1.velocity * (1 s) / (1 m)", "-2.5")
    (claim,) = loomfmu.limit(scene(share), vary="shaft.speed=300rpm..900rpm").claims
    (at,) = claim.limits
    # velocities are proportional to the speed: that at 600 rev/min says where -2.5 m/s is reached
    (verdict,) = loomfmu.evaluate(scene(("velocity", "above", "heald_1.velocity", "0 m/s"))).claims
    assert at.value == pytest.approx(600.0 * math.pi / 30.0 * 2.5 / -verdict.worst, rel=1e-8)


def test_the_derivative_of_an_expression_is_that_of_the_closed_form() -> None:
    # both frames stand at the ends of their strokes where the expression is largest, at 98 and at 0 mm
    apart = ("apart", "below", "heald_1.lift * heald_1.lift / (0.1 m) - 0.3 * heald_2.lift", "0.1 m")
    found = loomfmu.gradient(scene(apart), of=["apart"], by=["heald_1.stroke", "heald_2.stroke"])
    # the distance to the bound falls by 2 * 98 mm / 0.1 m; frame 2 is at 0 whatever its stroke
    assert found.si[0] == pytest.approx([-1.96, 0.0], abs=1e-6)


def test_the_highest_value_of_an_expression_is_derived() -> None:
    text = "highest heald_1.lift - heald_2.lift / 2"  # 98 mm where the other frame stands at 0
    found = loomfmu.gradient(scene(), of=text, by=["heald_1.stroke", "heald_2.stroke"])
    assert found.numbers == pytest.approx([0.098], abs=1e-12)
    assert found.si[0] == pytest.approx([1.0, 0.0], abs=1e-6)


def test_a_small_difference_is_near_a_bound_of_0_by_the_size_of_its_signals() -> None:
    """So a sweep estimates its error: it is far above 1 % of the difference itself."""
    differ = ("differ", "above", "heald_1.lift - 1.0000001 * heald_1.lift", "0 mm")
    apart = ("apart", "above", "heald_1.lift - 2 * heald_1.lift", "0 mm")
    found = loomfmu.evaluate(scene(differ, apart), errors="near")
    assert found.near == {0} and math.isfinite(found.claims[0].error) and math.isnan(found.claims[1].error)
