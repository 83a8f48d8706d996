"""Design functions: the physics of the FMUs, solved for a design. Uses numpy and scipy.

`loom` finds safe speeds, clearances, masses and stiffnesses, `cam` and `cam_export` shedding cams, `reed` the
dimensions of a beat-up linkage.
"""

from . import cam, cam_export, loom, reed

__all__ = ["cam", "cam_export", "loom", "reed"]
