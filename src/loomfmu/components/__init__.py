"""The components: one class for each FMU."""

from .belt_monitor import BeltMonitor
from .belt_wrap import BeltWrap
from .detaching_roller import DetachingRoller
from .dobby.drive import DobbyDrive
from .driven_shaft import DrivenShaft
from .heald_damper import HealdDamper
from .heald_frame import HealdFrame
from .main_shaft import MainShaft
from .pattern_lock import PatternLock
from .reed_beat_up import ReedBeatUp
from .warp_tension import WarpTension
from .weft_insertion import WeftInsertion

COMPONENTS = {
    component.__name__: component
    for component in (
        MainShaft,
        DrivenShaft,
        WeftInsertion,
        BeltMonitor,
        DobbyDrive,
        HealdFrame,
        HealdDamper,
        WarpTension,
        PatternLock,
        ReedBeatUp,
        BeltWrap,
        DetachingRoller,
    )
}
