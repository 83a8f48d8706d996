"""What instances of a standard loom share is set once, and the warp hangs on the carrier."""

from scene_texts import HEAD, MOTION, claim, parsed

from loomfmu.cosim.reading import checked_claims
from loomfmu.cosim.scenes.values import Values

LOOM = """
[loom]
weave = "10/01"
dampers = true
warps = true
play = true
[heald]
stroke = "90 mm"
[warp]
thread_stiffness = 80
[warp_2]
thread_count = 600
[damper]
creep_rate = 3
"""


def sources(text: str) -> dict[str, str]:
    """The output that each wired input takes."""
    return {".".join(wire.sink): ".".join(wire.source) for wire in parsed(text).wires}


def test_parameters_that_are_not_set_are_those_of_the_instance_that_they_belong_to() -> None:
    driven = '[shaft]\ncomponent = "DrivenShaft"\n' + LOOM
    instances = parsed(driven, damper_1__carrier_mass=5.0).instances
    assert [instances[name].values["stroke"] for name in ("warp_1", "damper_1", "damper_2")] == [0.09] * 3
    assert instances["damper_1"].values["thread_stiffness"] == 80.0
    assert [instances[f"{name}_2"].values["thread_count"] for name in ("damper", "play")] == [600, 600]
    assert instances["damper_1"].values["thread_count"] == 1260
    assert instances["damper_1"].values["creep_rate"] == 3.0  # its own value prevails
    assert instances["heald_1"].values["sprung_mass"] == 5.0
    assert instances["heald_2"].values["sprung_mass"] == 7.5


def test_all_of_a_frame_moves_with_it_where_its_load_is_not_wired() -> None:
    # at a constant speed nothing takes the torque: its carrier would neither move with it nor load it
    assert "sprung_mass" not in parsed(LOOM).instances["heald_1"].values
    wired = LOOM + '[wires]\n"heald_1.load" = "damper_1.transmitted_force"\n'
    assert parsed(wired).instances["heald_1"].values["sprung_mass"] == 7.5


def test_a_damper_without_warp_has_no_threads() -> None:
    instances = parsed('[loom]\nweave = "10"\ndampers = true\n').instances
    assert instances["damper_1"].effective()["thread_count"] == 0


def test_the_warp_and_the_healds_hang_on_the_carrier_and_no_wire_closes_a_loop() -> None:
    wires = sources(LOOM)
    assert wires["warp_2.lift"] == wires["play_2.lift"] == "damper_2.carrier_lift"
    assert wires["damper_2.lift"] == "heald_2.lift"
    assert wires["play_2.warp_load"] == "warp_2.frame_load"
    assert sources('[loom]\nweave = "10"\nwarps = true\n')["warp_1.lift"] == "heald_1.lift"


def load_of(text: str, name: str = "load") -> str | None:
    return sources(text).get(f"heald_1.{name}")


def test_carrier_or_warp_load_a_frame_whose_torque_a_shaft_feels() -> None:
    driven = '[shaft]\ncomponent = "DrivenShaft"\n[loom]\nweave = "10"\nwarps = true\n'
    assert load_of(driven + "dampers = true\n") == "damper_1.transmitted_force"
    assert load_of(driven) == "warp_1.frame_load"
    assert load_of(driven + '[wires]\n"heald_1.load" = false\n') is None
    # where nothing takes the torque, the wire would only close a loop
    assert load_of('[loom]\nweave = "10"\nwarps = true\ndampers = true\n') is None


def test_the_work_on_a_load_comes_from_where_the_load_comes_from() -> None:
    driven = '[shaft]\ncomponent = "DrivenShaft"\n[loom]\nweave = "10"\nwarps = true\n'
    dampers = driven + "dampers = true\n"
    assert load_of(dampers, "load_work") == "damper_1.frame_work"
    assert parsed(dampers).instances["heald_1"].values["use_load_work"]
    assert load_of(driven, "load_work") == "warp_1.frame_work"
    by_hand = dampers + '[wires]\n"heald_1.load" = "warp_1.frame_load"\n'
    assert load_of(by_hand, "load_work") == "warp_1.frame_work"
    # cut with the load; where it is cut alone, or the load is another model's, the torque is passed on
    assert load_of(dampers + '[wires]\n"heald_1.load" = false\n', "load_work") is None
    alone = dampers + '[wires]\n"heald_1.load_work" = false\n'
    assert "use_load_work" not in parsed(alone).instances["heald_1"].values
    other = dampers + '[wires]\n"heald_1.load" = "warp_2.frame_load"\n[warp_2]\n'
    assert load_of(other, "load_work") is None
    # at a constant speed nothing takes the work
    constant = LOOM + '[wires]\n"heald_1.load" = "damper_1.transmitted_force"\n'
    assert load_of(constant, "load_work") is None


def test_a_claim_on_a_torque_that_leaves_the_load_out_is_noted() -> None:
    def notes(*parts: str, signal: str = "heald_1.shaft_torque", bound: str = "1000 N.m") -> tuple[str, ...]:
        return checked_claims(parsed(*parts, claim("below", signal=signal, bound=bound))).scene.notes

    whole = "revolutions = 2\n" + LOOM
    (note,) = notes(whole)
    assert "leaves out damper_1.transmitted_force, because heald_1.load is not wired" in note
    assert notes(whole, '[wires]\n"heald_1.load" = "damper_1.transmitted_force"\n') == ()
    assert notes('[shaft]\ncomponent = "DrivenShaft"\n', LOOM) == ()
    for other in ("heald_1.shaft_work", "dobby.kinetic_energy"):
        assert notes(LOOM, signal=other, bound="1000 J") == ()
    assert notes('[loom]\nweave = "10"\n') == ()


def test_a_scene_may_hang_the_warp_on_the_frame() -> None:
    assert sources(LOOM + '[wires]\n"warp_1.lift" = "heald_1.lift"\n')["warp_1.lift"] == "heald_1.lift"


def test_values_of_a_prepared_scene_reach_those_that_share_them() -> None:
    for given in (
        {"warp_1.thread_stiffness": 55.0, "damper.carrier_mass": 6.0, "heald_2.stroke": 0.08},
        {"warp.thread_count": 900, "damper_1.thread_count": 100},
    ):
        read = parsed(LOOM, **given)
        values = Values(parsed(LOOM))
        assert all(values.targets(key) for key in given)
        found = values.set(given, given)
        assert {n: e.values for n, e in found.instances.items()} == {
            n: e.values for n, e in read.instances.items()
        }


def test_the_weft_is_wired_to_head_and_belt_and_changes_nothing_else() -> None:
    plain = '[loom]\nmachine = "WL680-3600"\n'
    with_yarn = plain + "yarn = true\n"
    assert sources(plain).items() <= sources(with_yarn).items()
    assert dict(sources(with_yarn).items() - sources(plain).items()) == {
        **{f"yarn.{name}": f"weft.{name}" for name in HEAD},
        **{f"yarn.shaft_{name}": f"shaft.{name}" for name in MOTION},
        "belt.yarn_tension": "yarn.tension",
    }
    assert "belt.yarn_tension" not in sources(with_yarn + '[wires]\n"belt.yarn_tension" = false\n')
