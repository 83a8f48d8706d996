"""Values that are none, huge or next to nothing, through FMUs: a clear message, or finite outputs."""

import math
import sys
from importlib.util import find_spec

import live_fmus
import pytest
from live_fmus import DISCARD, ERROR, FATAL, NAMES, OK, Live
from sharing import native_fmus

NONE = (math.nan, math.inf, -math.inf)
HUGE = (1.7e308, -1.7e308, 1e300, 1e100, -1e30, 1e20, 1e9, -1e9)
TINY = (5e-324, -5e-324, 1e-310, -1e-200, 1e-160, 1e-30)
SIZES = (0.0, 5e-324, 1e-300, 1e-9, 1e-3)


def fresh(instance: Live) -> None:
    instance.log.clear()
    assert instance.call("reset") == OK
    assert instance.call("setupExperiment", None, 0.0, None) == OK


def started(instance: Live) -> None:
    fresh(instance)
    assert instance.call("enterInitializationMode") == OK
    assert instance.call("exitInitializationMode") == OK


def refused(instance: Live, name: str, value: float) -> bool:
    """Whether a value is refused, by a message that names the variable, and with it every step to come.

    A live FMU can say so in its log alone, a native one by its status too.
    """
    status = instance.set(**{name: value})
    complaints = [text for level, _category, text in instance.log if level == ERROR]
    assert status in (OK, ERROR)
    assert bool(complaints) >= (status == ERROR)
    if not math.isfinite(value):
        assert complaints
    if complaints:
        assert complaints[0].startswith(f"{name} = ")
        assert " is outside [" in complaints[0]
        assert instance.step(0.0, 1e-3) in (DISCARD, ERROR, FATAL)
    return bool(complaints)


def settable(instance: Live, causality: str) -> list[str]:
    return [
        port.name
        for port in instance.fmu.ports.values()
        if port.causality == causality and port.kind == "Real"
    ]


def finite(instance: Live) -> bool:
    return all(math.isfinite(value) for value in instance.outputs())


def ran(instance: Live, status: int) -> bool:
    """Whether a step was made. If not it says why, by an error that names the variable or the matter."""
    if status == OK:
        assert finite(instance)
        return True
    assert status in (DISCARD, ERROR, FATAL)
    assert instance.texts
    # a line in words, and no exception of Python
    assert not any("\n" in text or "Error:" in text or "not finite" in text for text in instance.texts), (
        instance.texts
    )
    return False


def check_inputs(instance: Live) -> None:
    """Every bad value in every input, while it runs."""
    for name in settable(instance, "input"):
        for value in (*NONE, *HUGE, *TINY):
            started(instance)
            if refused(instance, name, value):
                continue
            time = 0.0
            for size in SIZES:
                if not ran(instance, instance.step(time, size)):
                    break
                time += size


def check_parameters(instance: Live) -> None:
    """Every bad value in every parameter, before it starts."""
    for name in settable(instance, "parameter"):
        for value in (*NONE, *HUGE, *TINY):
            fresh(instance)
            if refused(instance, name, value):
                continue
            statuses = [instance.call("enterInitializationMode"), instance.call("exitInitializationMode")]
            ran(instance, max(*statuses, instance.step(0.0, 1e-3)))


def check_together(instance: Live) -> None:
    """All inputs bad at once, each in another way."""
    names = settable(instance, "input")
    for shift in range(len(TINY) + len(HUGE)):
        started(instance)
        for n, name in enumerate(names):
            instance.set(**{name: (*TINY, *HUGE)[(shift + 5 * n) % (len(TINY) + len(HUGE))]})
        ran(instance, instance.step(0.0, 1e-3))


@pytest.fixture
def instance(name):
    made = Live(name)
    yield made
    made.free()


@pytest.fixture
def native(monkeypatch):
    if find_spec("ziglang") is None or not sys.platform.startswith("linux"):
        pytest.skip("no native FMU can be built here")
    built = native_fmus()
    monkeypatch.setattr(live_fmus.fmus, "of_component", lambda of: built[of])


@pytest.mark.parametrize("name", NAMES)
def test_bad_inputs_of_a_live_fmu(instance):
    check_inputs(instance)
    check_together(instance)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_bad_parameters_of_a_live_fmu(instance):
    check_parameters(instance)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_bad_values_of_a_native_fmu(native, instance):
    check_inputs(instance)
    check_together(instance)
    check_parameters(instance)
