"""Design functions: the physics of the FMUs, solved for a design. Uses numpy and scipy.

`loom` finds safe speeds, clearances, masses and stiffnesses, `buckling` fits the length factor to buckling
tests. `shed` finds where the warp has to be and when, `cam` and `rocker_cam` shedding cams for it,
`cam_export` writes them, `contact` finds their pressure. `reed` has the dimensions of a beat-up linkage,
`guidance` its synthesis from places of its rod. `dobby` has two older drives of dobbies. `loads` finds the
peaks of the loads that frames put on a dobby.
"""

from . import buckling, cam, cam_export, contact, dobby, guidance, loads, loom, reed, rocker_cam, shed

__all__ = [
    "buckling",
    "cam",
    "cam_export",
    "contact",
    "dobby",
    "guidance",
    "loads",
    "loom",
    "reed",
    "rocker_cam",
    "shed",
]
