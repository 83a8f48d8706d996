"""Other values for a scene that was read: where nothing else depends on them, it is not read again."""

from collections.abc import Collection, Mapping
from typing import Any

from ...components.shaft_driven import FOLLOWING
from ...declaring.variables import AT_STEP_END
from ...errors import LoomfmuError
from ...machines import TAKERS
from ...own.declared import FILES, ISOLATED, PARAMETER_SETS
from .instance_tables import overridden, prevailing
from .instances import Instance, altered
from .scene import Scene
from .settings import check_times

NOT_VALUES = (*PARAMETER_SETS, *FILES, ISOLATED)


class Values:
    """Sets parameters and start values of a scene as reading it with these overrides would."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self._targets: dict[str, list[tuple[str, str]]] = {}
        self._fed = {wire.sink for wire in scene.wires} | {(d.instance, d.variable) for d in scene.drives}

    def targets(self, key: str) -> list[tuple[str, str]]:
        """Return the variables that a key sets, as (instance, variable), or an empty list if it is not a
        value.

        Not a value is whatever may change which FMUs there are, how they are wired, which of them run, for
        how long, or what a scene warns of.
        """
        if key not in self._targets:
            self._targets[key] = self._found(key)
        return self._targets[key]

    def _found(self, key: str) -> list[tuple[str, str]]:
        scene = self.scene
        if scene.package is not None:  # a value may stand for several of its own
            return []
        try:
            pairs = overridden(scene.instances, key)
        except LoomfmuError:
            return []
        return (
            pairs if all(name and self._is_value(scene.instances[name], each) for name, each in pairs) else []
        )

    def _is_value(self, instance: Instance, variable: str) -> bool:
        port, component = instance.fmu.ports.get(variable), instance.fmu.component
        if port is None or port.own != variable or variable in NOT_VALUES:
            return False
        if variable in (FOLLOWING, AT_STEP_END) or (component and variable in component.unsteady):
            return False
        free = port.causality in ("parameter", "input") and (instance.name, variable) not in self._fed
        return free and not self._mixes(instance)

    def _mixes(self, instance: Instance) -> bool:
        """Return whether the scene compares its values with a machine or head that others name."""
        named = {kind for each in self.scene.instances.values() for kind in each.published}
        kinds = [kind for kind, takers in TAKERS.items() if instance.fmu.name in takers]
        return any(kind in named and kind not in instance.published for kind in kinds)

    def set(self, values: Mapping[str, Any], overrides: dict[str, Any]) -> Scene | None:
        """The scene with other values, out of all its overrides; None where it must be read anew.

        Raises LoomfmuError for a value that is not possible.
        """
        if not all(map(self.targets, values)):
            return None
        changed: dict[str, Instance] = {}

        def copied(name: str) -> Instance:
            if name not in changed:
                old = self.scene.instances[name]
                changed[name] = altered(old, values=dict(old.values), doubts=dict(old.doubts))
            return changed[name]

        taken = self.taken(values, overrides)
        for (name, variable), key in taken.items():
            copied(name).set(variable, values[key])
        for name, parameter in self.inheriting(taken):
            copied(name).take(parameter, changed)
        for name, each in changed.items():
            if any(each.doubts.values()) or any(self.scene.instances[name].doubts.values()):
                return None  # its values change what the scene warns of
        scene = altered(self.scene, instances=self.scene.instances | changed, overrides=overrides)
        if "shaft" in changed and "speed" in scene.instances["shaft"].fmu.ports:
            check_times(scene.times, scene.speed)
        return scene

    def taken(self, keys: Collection[str], overrides: Collection[str]) -> dict[tuple[str, str], str]:
        """The variables that take the values of some keys, out of all overrides, and the key of each.

        Raises LoomfmuError where two keys set the same one.
        """
        found = prevailing(overrides, self.targets)
        return {(name, variable): key for key, name, variable in found if key in keys}

    def inheriting(self, own: Collection[tuple[str, str]]) -> list[tuple[str, str]]:
        """The parameters that have the values of some variables, though not their own ones."""
        return [
            (name, parameter)
            for name, each in self.scene.instances.items()
            for parameter, owner in each.inherited.items()
            if owner in own and (name, parameter) not in own
        ]
