"""Fits: known values found again, intervals that cover them, published tests, what is refused."""

import csv
import math
import tomllib
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import loomfmu
from loomfmu import LoomfmuError, fit
from loomfmu.cli import main
from loomfmu.cosim.prepared import Prepared
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.design.buckling import fit_length_factor
from loomfmu.machines import table
from loomfmu.studies.fitting import fit as fitted
from loomfmu.studies.fitting.fitted_values import show

DEMO = Path(__file__).parents[3] / "sims" / "wl680_3600.toml"
HEADING = "time [s],belt.critical_force [N]"
# a belt whose free length is as many metres as the time is seconds
BELT = """
step = 0.01
duration = 1
[belt]
component = "BeltMonitor"
prescribe_length_factor = true
head_length = 0.0
idle_travel = 0.0
[inputs]
"belt.travel" = [[0.0, 0.0], [1.0, 1.0]]
"""
BENT = np.pi**2 * 0.25  # N m2, of which a length factor makes loads
FACTOR = "belt.prescribed_length_factor=0.5..2"


def written(rows: Iterable[tuple[Any, ...]], heading: str = HEADING) -> tuple[Path, Path]:
    """A scene of a belt and a measurement of it."""
    scene, data = Path("belt.toml"), Path("data.csv")
    scene.write_text(BELT)
    with data.open("w", newline="") as file:
        file.write(f"# measured somewhere\n{heading}\n")
        csv.writer(file).writerows(rows)
    return scene, data


def exact_loads(lengths: np.ndarray, trend: float = 0.0) -> list[tuple[float, float]]:
    """Rows of a measurement: the lengths and the critical loads of a factor of 0.8, with a trend [N/m]."""
    return [(length, BENT / (0.8 * length) ** 2 + trend * length) for length in lengths.tolist()]


def damper_in_last_turn(set: dict[str, Any]) -> Path:
    """The displacement of a damper over the shaft angle of the last of two revolutions, in display units."""
    run = loomfmu.evaluate(DEMO, set=set, values=["damper_1.displacement"]).trace
    degrees, values = np.degrees(run.shaft_angle[360:]) - 360.0, run["damper_1.displacement"][360:]
    rows = zip(degrees, 1e3 * values, strict=True)
    return written(rows, "shaft_angle [deg],damper_1.displacement [mm]")[1]


def test_no_place_is_run_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    short = {"revolutions": 2, "steps_per_revolution": 360, "damper_1.free_travel": "300 mm"}
    data = damper_in_last_turn(short | {"damper_1.spring_stiffness": "7 N/mm"})
    seen = {"evaluate": [], "derived": []}
    for name, places in seen.items():
        run = getattr(Prepared, name)

        def counted(self: Prepared, given: Any = None, *rest: Any, run=run, places=places, **how: Any) -> Any:
            places.append(str(given))
            return run(self, given, *rest, **how)

        monkeypatch.setattr(Prepared, name, counted)
    vary = ["damper_1.spring_stiffness=1N/mm..20N/mm", "damper_1.damping_ratio=0..0.5"]
    found = fit(DEMO, data, vary=vary, set=short, loss="cauchy")
    assert found.parameters[0].value == pytest.approx(7e3, rel=1e-6)
    evaluated, derived = seen.values()
    assert len(set(evaluated)) == len(evaluated) and len(set(derived)) == len(derived)
    assert found.runs == len(evaluated) - 1 + len(derived)  # one more for the warnings of the scene


def test_published_buckling_tests_give_the_length_factor_of_the_closed_form() -> None:
    """Zhu 2021, Tables 2 and 3: the fit over runs is that of `design.fit_length_factor` over the equation."""
    tests = [
        (float(row["free_length_mm"]) / 1e3, float(row["c_0.30"]))
        for row in table("belt_buckling_experiment")
    ]
    scene, data = written(tests)
    found = fit(scene, data, vary=FACTOR)
    closed = fit_length_factor(*zip(*tests, strict=True))
    (factor,) = found.parameters
    # lengths lie between samples 10 mm apart: the cubic through 1 / l^2 is off by less than 1e-6
    assert factor.value == pytest.approx(closed.factor, rel=1e-6)
    assert factor.value == pytest.approx(0.80, abs=0.005)  # as printed
    # a linear model of the factor around the result against one of its inverse square: alike to first order
    half = (factor.high - factor.low) / 2.0
    # Student's t, 2 degrees of freedom
    assert half == pytest.approx(4.302653 * closed.standard_error, rel=1e-3)
    assert found.curves[0].rms == pytest.approx(np.sqrt(np.mean(np.square(closed.residuals))), rel=1e-5)


VARY = ["damper_1.spring_stiffness=1N/mm..20N/mm", "damper_1.damping_ratio=0..0.5"]
IN_LOOM = {"damper_1.free_travel": "300 mm", "steps_per_revolution": 360, "revolutions": 2}


def test_values_that_made_the_data_are_found_again() -> None:
    made = {"damper_1.spring_stiffness": "7.1 N/mm", "damper_1.damping_ratio": 0.12}
    found = fit(DEMO, damper_in_last_turn(IN_LOOM | made), vary=VARY, set=IN_LOOM)
    # 3-point slopes of shares of the ranges leave 1e-10 of them
    assert [each.value for each in found.parameters] == pytest.approx([7100.0, 0.12], rel=1e-9)
    assert found.curves[0].rms < 1e-12
    assert loomfmu.evaluate(DEMO, set=IN_LOOM | found.values)


def test_an_offset_compares_the_last_whole_revolution_and_no_other() -> None:
    """The one before is another pick of a plain weave. A run that does not cover the shifts is refused."""
    data = damper_in_last_turn(IN_LOOM)
    how = {"vary": "damper_1.damping_ratio=0..0.5", "offset": "-3deg..3deg"}
    with pytest.raises(LoomfmuError, match="with an offset of 3 deg, but the run goes from 0 to 720 deg"):
        fit(DEMO, data, set=IN_LOOM, **how)
    found = fit(DEMO, data, set=IN_LOOM | {"revolutions": 2.1}, **how)
    assert found.parameters[1].value == pytest.approx(0.0, abs=1e-9)
    assert found.curves[0].rms < 1e-9


LENGTHS = np.linspace(0.3, 0.9, 61)


def noise_of(kind: str, random: np.random.Generator) -> np.ndarray:
    """Noise of 0.5 N, independent or with a memory of 0.9 from one value to the next."""
    noise = random.normal(0.0, 0.5, len(LENGTHS))
    for place in range(1, len(LENGTHS)) if kind == "memory" else ():
        noise[place] = 0.9 * noise[place - 1] + np.sqrt(1.0 - 0.81) * noise[place]
    return noise


def belt_fit(kind: str, random: np.random.Generator) -> fitted.Fit:
    """A fit of a length factor of 0.8 to measured loads; the lengths are 20 mm off where kind is "offset"."""
    loads = BENT / (0.8 * (LENGTHS + 20e-3 * (kind == "offset"))) ** 2 + noise_of(kind, random)
    data = written(list(zip(LENGTHS, loads, strict=True)))
    return fit(*data, vary=FACTOR)


def covers(found: fitted.Fit, *true: float) -> list[bool]:
    return [each.low <= value <= each.high for each, value in zip(found.parameters, true, strict=True)]


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "most"), [("", 8), ("memory", 0), ("offset", 0)])
def test_an_interval_covers_the_truth_or_is_not_trusted(kind: str, most: int) -> None:
    random = np.random.default_rng(2026)
    found = [belt_fit(kind, random) for _try in range(8)]
    # of 8 intervals of 95 % 6 or more cover the truth in all but 1 of 500 draws; as many are trusted
    assert most - 2 <= sum(each.trusted for each in found) <= most
    assert sum(each.trusted and not covers(each, 0.8)[0] for each in found) <= 2 * bool(most)
    assert all(covers(each, 0.8)[0] for each in found) == bool(most)


@pytest.mark.slow
def test_intervals_cover_the_truth_as_often_as_they_say() -> None:
    random, tries = np.random.default_rng(2026), 200
    found = [belt_fit("", random) for _try in range(tries)]
    # 190 are expected; binomial with p = 0.95 leaves 180 to 198 in all but 1 of 500 draws
    assert 180 <= sum(covers(each, 0.8)[0] for each in found) <= 198
    assert sum(each.trusted for each in found) >= 180


DAMPER = {"damper_1.spring_stiffness": 7.1e3, "damper_1.damping_ratio": 0.12}
HELD = IN_LOOM | {"revolutions": 3}


@cache
def swing() -> CubicSpline:
    """What a damper with known values does."""
    run = loomfmu.evaluate(DEMO, set=HELD | DAMPER, values=["damper_1.displacement"]).trace
    return CubicSpline(run.time, run["damper_1.displacement"])


def damper_fit(random: np.random.Generator, memory: float, late: float, **how: Any) -> fitted.Fit:
    """A fit to its swing in the second revolution, with 0.1 mm of noise, recorded too early by `late`."""
    time = np.linspace(1.0, 2.0, 180, endpoint=False) * swing().x[-1] / 3.0
    noise = random.normal(0.0, 1e-4, len(time))
    for place in range(1, len(time)):
        noise[place] = memory * noise[place - 1] + np.sqrt(1.0 - memory**2) * noise[place]
    rows = list(zip(time, 1e3 * (swing()(time + late) + noise), strict=True))
    data = written(rows, "time [s],damper_1.displacement [mm]")[1]
    return fit(DEMO, data, vary=VARY, set=HELD, **how)


def test_an_offset_in_time_is_said_and_fitted(capsys: pytest.CaptureFixture[str]) -> None:
    found = damper_fit(np.random.default_rng(0), 0.0, 5e-4)
    assert not found.trusted and not any(covers(found, *DAMPER.values()))
    assert found.shift and found.shift.size == pytest.approx(5e-4, abs=4.0 * found.shift.error)
    show(found)
    said = " ".join(capsys.readouterr().out.split())
    assert "damper_1.displacement: residuals are not independent: Durbin-Watson 0.43 where 2.01" in said
    assert "the residuals show an offset of the data, 0.48 ms +- 0.039 ms" in said
    assert "0.1116688 to 0.1138497, not to be trusted" in said and "not to be trusted" in found._repr_html_()
    assert "residuals are not independent" in found.write(Path("fitted.toml")).read_text()
    free = damper_fit(np.random.default_rng(0), 0.0, 5e-4, offset="-3ms..3 ms")
    assert free.trusted and all(covers(free, *DAMPER.values(), 5e-4)) and free.shift is None
    assert [*free.values] == [*DAMPER]  # the offset is not one of the scene's


@pytest.mark.slow
@pytest.mark.parametrize(
    ("memory", "late", "unsaid"), [(0.0, 0.0, 0.05), (0.2, 0.0, 0.05), (0.9, 0.0, 0.0), (0.0, 1.5e-4, 0.0)]
)
def test_intervals_that_miss_are_not_trusted(memory: float, late: float, unsaid: float) -> None:
    random, tries, wrong = np.random.default_rng(31), 60, np.zeros(2)
    for _try in range(tries):
        found = damper_fit(random, memory, late)
        wrong += found.trusted & ~np.array(covers(found, *DAMPER.values()))
    # binomial with p = 0.05 leaves 8 of 60 or fewer in all but 1 of 500 draws
    assert np.all(wrong <= (8 if unsaid else 0))


@pytest.mark.few(1)
@pytest.mark.parametrize("loss", ["soft_l1", "huber", "cauchy", "arctan"])
def test_a_robust_loss_passes_over_values_that_are_far_off(loss: str) -> None:
    random = np.random.default_rng(3)
    loads = BENT / (0.8 * LENGTHS) ** 2 + random.normal(0.0, 0.1, len(LENGTHS))
    loads[::10] += 8.0
    data = written(list(zip(LENGTHS, loads, strict=True)))
    plain, robust = (fit(*data, vary=FACTOR, loss=each) for each in ("linear", loss))
    (lax,), (tight,) = plain.parameters, robust.parameters
    assert lax.high - lax.low > 5.0 * (tight.high - tight.low) and not covers(plain, 0.8)[0]
    assert tight.value == pytest.approx(0.8, abs=2e-3)
    assert robust.loss == loss


def test_several_signals_are_weighed_by_their_own_noise() -> None:
    random = np.random.default_rng(7)
    lengths = np.linspace(0.3, 0.9, 61)
    loads = BENT / (0.8 * lengths) ** 2 + random.normal(0.0, 0.01, 61)
    lying = 1e3 * lengths * 1.05 + random.normal(0.0, 50.0, 61)  # mm: 5 % too long
    rows = list(zip(lengths, loads, lying, strict=True))
    scene, data = written(rows, f"{HEADING},belt.free_length [mm]")
    vary = [FACTOR, "belt.idle_travel=0mm..100mm"]
    factor, idle = fit(scene, data, vary=vary).parameters
    assert factor.low < 0.8 < factor.high and factor.high - factor.low < 1e-3
    # what the lying lengths ask for, -30 mm, counts little against the exact loads
    assert idle.low < 0.0 < idle.high < 1e-3


@pytest.mark.slow
def test_intervals_cover_with_two_signals_of_different_size() -> None:
    """The smaller signal has 12 values, two of whose degrees of freedom the parameters may take."""
    random = np.random.default_rng(11)
    lengths = np.linspace(0.3, 0.9, 60)
    few = np.arange(60) % 5 == 2
    covered, tries = np.zeros(2), 100
    for _try in range(tries):
        loads = BENT / (0.8 * (lengths - 0.02)) ** 2 + random.normal(0.0, 0.5, 60)
        free = 1e3 * (lengths - 0.02) + random.normal(0.0, 2.0, 60)
        rows = [(a, b, c if here else "") for a, b, c, here in zip(lengths, loads, free, few, strict=True)]
        vary = [FACTOR, "belt.idle_travel=0mm..100mm"]
        found = fit(*written(rows, f"{HEADING},belt.free_length [mm]"), vary=vary).parameters
        covered += [each.low <= true <= each.high for each, true in zip(found, (0.8, 0.02), strict=True)]
    # 95 are expected; binomial with p = 0.95 leaves 88 or more in all but 1 of 500 draws, and the noise of
    # twelve values, known to a fifth, costs some
    assert np.all(covered >= 86)


def test_the_scene_with_the_fitted_values_runs_and_keeps_its_comments() -> None:
    rows = [(length, BENT / (0.83 * length) ** 2) for length in (0.4, 0.5, 0.6)]
    scene, data = written(rows)
    scene.write_text(BELT.replace("[belt]", "[belt] # the new one"))
    found = fit(scene, data, vary=FACTOR)
    path = found.write(Path("fitted.toml"))
    assert "[belt] # the new one" in path.read_text()
    assert f"{found.scene.file.name} with " in path.read_text() and "fitted to data.csv." in path.read_text()
    again = loomfmu.prepare(path).scene.instances["belt"].effective()["prescribed_length_factor"]
    assert again == found.parameters[0].value
    found = replace(found, scene=scenes.load(scene, {"belt.guide_clearance": "0.4 mm"}))
    assert ", and with belt.guide_clearance = 0.4 mm." in found.write(Path("set.toml")).read_text()
    with Path("set.toml").open("a") as edited:
        edited.write("# mine\n")
    with pytest.raises(
        LoomfmuError, match=r"set\.toml: exists and is not a scene that loomfmu wrote and nobo"
    ):
        found.write(Path("set.toml"))
    assert found.write(path) == path
    assert scene.read_text() == BELT.replace("[belt]", "[belt] # the new one")


def test_warnings_of_the_scene_and_of_ranges_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    scene, data = written([(0.1 * k, BENT / (0.1 * k) ** 2) for k in range(1, 9)])
    with scene.open("a") as file:
        file.write('[drive]\ncomponent = "WeftInsertion"\nfollow_shaft = true\nspeed = "300 rpm"\n')
    assert main(["fit", str(scene), str(data), "--vary", FACTOR]) == 0
    assert "warning: drive.speed has no effect: set drive.follow_shaft = false" in capsys.readouterr().err


NINE = exact_loads(np.linspace(0.3, 0.9, 9), trend=0.1)
FEW = [(a, load, 1e3 * a if a < 0.5 else "") for a, load in exact_loads(np.linspace(0.3, 0.9, 25))]
BOTH = f"{HEADING},belt.free_length [mm]"


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"vary": "belt.head_mass=0.1kg..0.2kg"}, "belt.head_mass changes none of the measured signals"),
        ({"vary": ["belt.bending_stiffness=0.1..0.4", FACTOR]},
         "cannot tell belt.bending_stiffness and belt.prescribed_length_factor apart"),
        ({"vary": "belt.prescribed_length_factor=2..0.5"}, "is empty"),
        ({"vary": [FACTOR, FACTOR]}, "is varied twice"),
        ({"vary": "belt.length_faktor=0.5..2"}, "length_factor"),
        ({"vary": []}, "name at least one parameter"),
        ({"offset": "2ms"}, r"offset = '2ms' is not a range such as -2ms\.\.2ms"),
        ({"offset": "-2deg..2deg"}, "which does not fit s; the data are over time"),
        ({"offset": "-2..2"}, "offset = '-2' has no unit"),
        ({"offset": "2ms..-2ms"}, "offset: the range from 2 ms to -2 ms is empty"),
        ({"offset": "-2s..2s"},
         r"measured from 0\.3 to 0\.9 s, with an offset of -2 s, but the run goes from 0"),
        ({"loss": "hubert"}, "loss = 'hubert' is not one of .*; did you mean 'huber'?"),
        ({"loss": "huber"}, "has 9 values, but loss = huber with 1 parameter takes at least 11"),
        ({"rows": [(0.4, 20.0)]}, "1 value cannot determine 1 parameter with"),
        ({"rows": [(0.4, 20.0), (1.4, 5.0)]},
         r"measured from 0\.4 to 1\.4 s, but the run goes from 0 to 1 s"),
        ({"rows": FEW, "heading": BOTH}, r"belt\.free_length has 8 values, but .* at least 11"),
        ({"heading": HEADING.replace("time [s]", "shaft_angle [deg]")}, "no shaft turns in this scene"),
    ],
)  # fmt: skip
def test_what_cannot_be_fitted_is_refused(how: dict[str, Any], said: str) -> None:
    files = written(how.pop("rows", NINE), how.pop("heading", HEADING))
    with pytest.raises(LoomfmuError, match=said):
        fit(*files, **{"vary": FACTOR} | how)


def test_an_accuracy_is_refused() -> None:
    with pytest.raises(LoomfmuError, match=r"accuracy = 0\.001 chooses steps by .*; set steps_per_rev"):
        fit(DEMO, "data.csv", vary="damper_1.stiffness=500N/m..2kN/m", set={"accuracy": 1e-3})


def test_coarse_steps_are_noted() -> None:
    rows = exact_loads(np.linspace(0.305, 0.895, 20))
    scene, data = written(rows)
    scene.write_text(BELT.replace("step = 0.01", "step = 0.1"))
    found = fit(scene, data, vary=FACTOR)
    assert "interpolation is off by" in found.notes[-1] and found.notes[-1].endswith("take more steps")


def test_the_command_prints_and_writes(capsys: pytest.CaptureFixture[str]) -> None:
    rows = exact_loads(np.linspace(0.3, 0.9, 25), trend=0.1)
    scene, data = written(rows)
    words = ["fit", str(scene), str(data), "--vary", FACTOR]
    outputs = ["--output", "fitted.toml", "--picture", "fit.svg"]
    assert main([*words, *outputs]) == 0
    said = capsys.readouterr().out
    assert "belt.prescribed_length_factor" in said and "rms over 25 values" in said
    assert Path("fit.svg").read_text().startswith("<?xml")
    assert main([*words, "--output", str(scene)]) == 2
    assert "is an input of this command" in capsys.readouterr().err
    assert main([*words, "--output", "fitted.txt"]) == 2
    assert "a scene is written as .toml" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("factor", "range_", "said"),
    [
        (1.0, "0.82..2", ["belt.prescribed_length_factor ended at 0.82, the end of its range: widen it"]),
        (
            1e3,  # N in a column of kN
            "0.5..2",
            [
                "belt.critical_force: the fit explains nothing of the variation of the data;"
                " check the units and the rest of the scene",
                "belt.prescribed_length_factor ended at 0.5, the end of its range",
            ],
        ),
    ],
)
def test_a_fit_that_is_of_no_use_has_status_1_and_its_scene_says_so(
    capsys: pytest.CaptureFixture[str], factor: float, range_: str, said: list[str]
) -> None:
    rows = [(length, factor * BENT / (0.8 * length) ** 2) for length in np.linspace(0.3, 0.9, 25)]
    output = Path("fitted.toml")
    words = ["--vary", f"belt.prescribed_length_factor={range_}", "--output", str(output)]
    assert main(["fit", *map(str, written(rows)), *words]) == 1
    printed = capsys.readouterr().out
    assert "e+02 %" not in printed
    description = tomllib.loads(output.read_text())["description"].splitlines()
    assert set(said) <= set(description) & set(printed.splitlines())


def test_data_that_do_not_vary_are_not_explained_by_a_curve_that_misses_them() -> None:
    rows = [(length, 0.0) for length in np.linspace(0.3, 0.9, 25)]
    found = fit(*written(rows), vary=FACTOR)
    assert found.curves[0].share == math.inf and not found.curves[0].explained
    assert any("does not reach the data, which do not vary" in each for each in found.notes)
    assert not any("nan" in each or "e+" in each for each in found.notes)


def test_a_parameter_that_an_offset_mimics_is_not_fitted_beside_it() -> None:
    """At a constant speed a later beat-up is an offset of all times; the interval missed the truth."""
    scene, data = Path("reed.toml"), Path("reed.csv")
    scene.write_text(
        'revolutions = 3.1\nsteps_per_revolution = 90\n[loom]\nmachine = "WL680-3600"\n'
        'head = "G6300 left"\nreed = true\n[shaft]\nspeed = "300 rev/min"\n'
    )
    true = loomfmu.prepare(scene, values=["reed.position"]).evaluate({"reed.beat_up_angle": 0.0712}).trace
    noise = np.random.default_rng(0).normal(0.0, 1e-4, len(true.time))
    rows = zip(true.time[10:250:3], (true["reed.position"] + noise)[10:250:3], strict=True)
    data.write_text("time [s],reed.position [m]\n" + "".join(f"{float(t)},{float(x)}\n" for t, x in rows))
    with pytest.raises(LoomfmuError, match=r"cannot tell reed\.beat_up_angle and offset apart; fit only one"):
        fit(scene, data, vary="reed.beat_up_angle=-0.5rad..0.5rad", offset="-2ms..2ms")
