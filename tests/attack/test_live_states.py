"""A host that keeps no rules on live FMUs: random calls, damaged states, states forged with their checksum.

Each FMU runs in a process of its own, where a crash is seen and a call without end meets the time limit.
"""

import json

import pytest
from attack_figures import record
from live_fmus import NAMES, in_a_process

ATTACK = """
import json, logging, math, random, struct, sys, zlib
from live_fmus import *
logging.getLogger("loomfmu.live").disabled = True
name, seed, calls = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
rng = random.Random(f"{name} {seed}")
instance = Live(name).start()
slave = instance.slave
ports = list(instance.fmu.ports.values())
kinds = {"Real": "<d", "Integer": "<q", "Boolean": "<?"}
places, place = [], 46
for port in ports:
    places.append(place)
    place += struct.calcsize(kinds[port.kind])
odd = [0.0, -0.0, 1.0, -1.0, 5e-324, 1e18, 1e300, -1e300, math.nan, math.inf, -math.inf]
done = dict.fromkeys(("calls", "steps", "failed steps", "states", "damaged", "forged", "refused", "taken"), 0)
good = bytes(slave.serializeFMUState(slave.getFMUState()))


def again():
    assert instance.call("reset") == OK
    instance.start()


def any_real():
    return rng.choice(odd) if rng.random() < 0.3 else rng.uniform(-1, 1) * 10.0 ** rng.randint(-12, 12)


def value(port, settable):
    if port.kind == "Boolean":
        return rng.random() < 0.5
    if port.kind == "Integer":
        return rng.choice([0, 1, -1, 2, 36, 2**31 - 1, -2**31, rng.randint(-100, 100)])
    return port.start * rng.uniform(0.9, 1.1) if settable and rng.random() < 0.8 else any_real()


def set_something():
    port = rng.choice(ports)
    kind = port.kind if rng.random() < 0.95 else rng.choice(list(kinds))
    given = value(port, port.causality in ("input", "parameter"))
    given = float(given) if kind == "Real" else bool(given) if kind == "Boolean" else 7
    assert instance.call(f"set{kind}", [port.reference], [given]) == OK


def get_something():
    port = rng.choice(ports)
    kind = port.kind if rng.random() < 0.95 else rng.choice(list(kinds))
    reference = port.reference if rng.random() < 0.98 else rng.choice([0, 9999, 4294967295])
    try:
        getattr(slave, f"get{kind}")([reference])
    except FMICallException as error:
        assert error.status == FATAL
        again()
    if kind != port.kind or reference != port.reference:
        assert instance.step(0.0, 1e-3) == FATAL
        again()


def step():
    time = rng.random() if rng.random() < 0.9 else any_real()
    size = rng.random() * 1e-2 if rng.random() < 0.9 else any_real()
    status = instance.step(time, size)
    assert status in (OK, FATAL)
    done["steps" if status == OK else "failed steps"] += 1
    if status == FATAL and rng.random() < 0.8:
        again()


def life():
    for method, arguments in rng.choices((
        ("setupExperiment", (None, any_real(), rng.choice([None, any_real()]))),
        ("enterInitializationMode", ()),
        ("exitInitializationMode", ()), ("terminate", ()), ("reset", ()),
    ), k=rng.randint(1, 3)):
        assert instance.call(method, *arguments) in (OK, FATAL)
    if rng.random() < 0.8:
        again()


def state():
    # what was saved goes on with the same bits, and so does what was written and read back
    again()
    for number in range(rng.randint(0, 3)):
        instance.set(**excited(COMPONENTS[name], number * 1e-3))
        instance.step(number * 1e-3, 1e-3)
    saved = slave.getFMUState()
    data = bytes(slave.serializeFMUState(saved))
    ends = []
    for restored in (saved, slave.deSerializeFMUstate(data)):
        assert instance.call("setFMUState", restored) == OK
        assert instance.step(4e-3, 1e-3) == OK, instance.texts
        ends.append(instance.variables())
        slave.freeFMUState(restored)
    assert ends[0] == ends[1] or any(each != each for each in ends[0])
    done["states"] += 1


def set_bytes(data):
    restored = slave.deSerializeFMUstate(data)
    instance.log.clear()
    assert instance.call("setFMUState", restored) == OK
    slave.freeFMUState(restored)
    return "the FMU state is damaged, or of another FMU or another version of this one" not in instance.texts


def damage():
    data = bytearray(good)
    for _ in range(rng.randint(1, 4)):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    if rng.random() < 0.2:
        data = data[: rng.randrange(1, len(data))]
    if bytes(data) == good:
        return
    assert not set_bytes(bytes(data)), data.hex()
    assert instance.step(0.0, 1e-3) == FATAL
    done["damaged"] += 1
    again()


def forge():
    # any values of the right layout: refused, or it goes on without a crash and without end
    data = bytearray(good[:-4])
    for _ in range(rng.randint(1, 3)):
        port, place = rng.choice(list(zip(ports, places)))
        packed = struct.pack(kinds[port.kind], value(port, False))
        data[place : place + len(packed)] = packed
    taken = set_bytes(bytes(data) + zlib.crc32(data).to_bytes(4, "little"))
    done["taken" if taken else "refused"] += 1
    done["forged"] += 1
    for number in range(2):
        status = instance.step(number * 1e-3, 1e-3)
        assert status in ((OK, FATAL) if taken else (FATAL,))
    again()


acts = [set_something, get_something, step, step, life, state, damage, forge]
for _ in range(calls):
    done["calls"] += 1
    rng.choice(acts)()
    instance.log.clear()
instance.free()
print(json.dumps(done))
"""


def attack(name: str, seed: int, calls: int) -> dict[str, int]:
    """Figures of one process that was attacked and survived."""
    done: dict[str, int] = json.loads(in_a_process(ATTACK, name, str(seed), str(calls), timeout=600.0))
    print(f"{name}, seed {seed}: {done}")
    assert done["calls"] == calls  # tried, and survived
    record("random calls and states of live FMUs", calls, done["damaged"] + done["refused"])
    return done


@pytest.mark.few(3)
@pytest.mark.parametrize("name", NAMES)
def test_random_calls_and_states_do_no_harm(name: str) -> None:
    done = attack(name, 1, 600)
    # an eighth of the calls each, less the damage that undid itself
    assert done["steps"] > 20 and done["states"] > 40 and done["damaged"] > 40 and done["forged"] > 40
    assert done["refused"] > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 6))
@pytest.mark.parametrize("name", NAMES)
def test_many_random_calls_and_states_do_no_harm(name: str, seed: int) -> None:
    assert attack(name, seed, 20000)["damaged"] > 2000
