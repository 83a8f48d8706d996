"""One claim, judged on a recorded run by a call."""

from typing import Any, Literal

from ..cosim.claims.claims import read
from ..errors import LoomfmuError, shown
from ..traces import Signals, Verdict

Kind = Literal[  # for editors and type checkers; a test holds it to the classes
    "above",
    "below",
    "belt_deflection",
    "clear_shed",
    "dwell",
    "dwell_contains",
    "energy_balance",
    "heald_blows",
    "locks_in_time",
    "lowest_margin",
    "motor_power",
    "nip_holds",
    "peak_load",
    "rapier_in_open_shed",
    "reed_clear_of_rapier",
    "speed_fluctuation",
    "stop_contacts",
    "transfer_in_time",
    "transfer_speed",
]


def judge(trace: Signals, *, kind: Kind, **arguments: Any) -> Verdict:
    """Judge one claim on a trace.

    Args:
        trace: a recorded run, such as `result.trace`
        kind: such as "above"; arguments are those of that kind, with units or in SI, and `name`, what the
            verdict calls the claim

    Raises:
        LoomfmuError: an unknown kind, argument, signal or unit, or a missing one
    """
    if not isinstance(trace, Signals):
        raise LoomfmuError(f"trace = {shown(trace)} is not a trace, such as result.trace")
    return read({"kind": kind, **arguments}, trace.unit).judge(trace)
