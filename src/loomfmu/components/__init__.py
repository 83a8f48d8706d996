"""The components: one class for each FMU."""

from collections.abc import Iterator, MutableMapping
from importlib import import_module
from typing import Any

from ..declaring.variables import Component

MODULES = {
    "MainShaft": "main_shaft",
    "DrivenShaft": "driven_shaft",
    "WeftInsertion": "weft_insertion",
    "BeltMonitor": "belt_monitor",
    "BeltDynamics": "belt_dynamics",
    "WeftTension": "weft_tension",
    "WeftTransfer": "weft_transfer",
    "DobbyDrive": "dobby.drive",
    "HealdFrame": "heald_frame",
    "HealdDamper": "heald_damper",
    "WarpTension": "warp_tension",
    "HealdPlay": "heald_play",
    "PatternLock": "pattern_lock",
    "ReedBeatUp": "reed_beat_up",
    "BeltWrap": "belt_wrap",
    "DetachingRoller": "detaching_roller",
}


class Components(MutableMapping[str, type[Component]]):
    """Classes by their names. Each is imported when it is first needed: a loom has half of them."""

    def __init__(self, modules: dict[str, str]):
        self._classes: dict[str, type[Component] | None] = dict.fromkeys(modules)

    def __getitem__(self, name: str) -> type[Component]:
        found = self._classes[name]
        if found is None:
            found = self._classes[name] = getattr(import_module(f".{MODULES[name]}", __name__), name)
        return found

    def __setitem__(self, name: str, component: type[Component]) -> None:
        self._classes[name] = component

    def __delitem__(self, name: str) -> None:
        del self._classes[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._classes)

    def __contains__(self, name: object) -> bool:
        return name in self._classes

    def __len__(self) -> int:
        return len(self._classes)

    def owns(self, component: type[Component] | None) -> bool:
        """Return whether a class is one of these, without importing the others."""
        return component is not None and self._classes.get(component.__name__) is component


COMPONENTS = Components(MODULES)


def __getattr__(name: str) -> Any:
    """A class by its name."""
    if name not in MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return COMPONENTS[name]
