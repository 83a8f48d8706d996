"""Ways of values through the connectors of systems."""

from xml.etree.ElementTree import fromstring

import pytest

from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp.connections import Nets

# the outer system's `u` leads into two systems, each with one component behind its own `u`
INNER = """
<ssd:System name="{0}"><ssd:Connectors><ssd:Connector name="u" kind="input"/></ssd:Connectors>
 <ssd:Elements><ssd:Component name="f"/></ssd:Elements>
 <ssd:Connections>
  <ssd:Connection startConnector="u" endElement="f" endConnector="shaft_angle"/>
 </ssd:Connections></ssd:System>"""
OUTER = f"""<ssd:System xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription">
<ssd:Connectors><ssd:Connector name="u" kind="input"/></ssd:Connectors>
<ssd:Elements>{INNER.format("s")}{INNER.format("t")}</ssd:Elements>
<ssd:Connections>
 <ssd:Connection startConnector="u" endElement="s" endConnector="u"/>
 <ssd:Connection startConnector="u" endElement="t" endConnector="u"/>
</ssd:Connections></ssd:System>"""
NAMES = {("s", "f"): "one", ("t", "f"): "two"}


@pytest.mark.parametrize(
    ("path", "reached"), [((), [*NAMES]), (("s",), [("s", "f")]), (("t",), [("t", "f")])]
)
def test_what_enters_a_system_does_not_leave_it(
    path: tuple[str, ...], reached: list[tuple[str, ...]]
) -> None:
    components = "\n".join(f'[{name}]\ncomponent = "WeftInsertion"' for name in NAMES.values())
    instances = scenes.parse(f"duration = 1\nstep = 0.1\n{components}", "two", {}).instances
    inner = {(path, "u"): None for path in ((), ("s",), ("t",))}
    nets = Nets(fromstring(OUTER), instances, NAMES, inner)
    assert [each.node[0] for each in nets.reached((path, "u"), None)] == reached
