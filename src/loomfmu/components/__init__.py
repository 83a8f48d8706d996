"""The components: one class for each FMU."""

from .belt_monitor import BeltMonitor
from .dobby_drive import DobbyDrive
from .heald_damper import HealdDamper
from .heald_frame import HealdFrame
from .main_shaft import MainShaft
from .weft_insertion import WeftInsertion

COMPONENTS = {
    component.__name__: component
    for component in (MainShaft, WeftInsertion, BeltMonitor, DobbyDrive, HealdFrame, HealdDamper)
}
