"""Ways of values through the connectors of systems."""

from xml.etree.ElementTree import fromstring

import pytest

from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp.connections import Nets
from loomfmu.cosim.ssp.structure import Node

# the outer system's `u` leads into two systems, each with one component behind its own `u`
INNER = """
<ssd:System name="{0}">
 <ssd:Connectors>
  <ssd:Connector name="u" kind="input"/><ssd:Connector name="y" kind="output"/>
 </ssd:Connectors>
 <ssd:Elements><ssd:Component name="f"/></ssd:Elements>
 <ssd:Connections>
  <ssd:Connection startConnector="u" endElement="f" endConnector="shaft_angle"/>
  <ssd:Connection startConnector="u" endConnector="y"/>
 </ssd:Connections></ssd:System>"""
OUTER = f"""<ssd:System xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription">
<ssd:Connectors><ssd:Connector name="u" kind="input"/></ssd:Connectors>
<ssd:Elements>{INNER.format("s")}{INNER.format("t")}<ssd:Component name="g"/></ssd:Elements>
<ssd:Connections>
 <ssd:Connection startConnector="u" endElement="s" endConnector="u"/>
 <ssd:Connection startConnector="u" endElement="t" endConnector="u"/>
 <ssd:Connection startElement="s" startConnector="y" endElement="g" endConnector="shaft_angle"/>
</ssd:Connections></ssd:System>"""
F_IN_S, F_IN_T, G = NAMES = {("s", "f"): "one", ("t", "f"): "two", ("g",): "three"}


def nets(structure: str) -> Nets:
    components = "\n".join(f'[{name}]\ncomponent = "WeftInsertion"' for name in NAMES.values())
    instances = scenes.parse(f"duration = 1\nstep = 0.1\n{components}", "three", {}).instances
    inner = {(path, name): None for path in ((), ("s",), ("t",)) for name in "uy"}
    return Nets(fromstring(structure), instances, NAMES, inner)


@pytest.mark.parametrize(
    ("start", "reached"),
    [
        (((), "u"), {F_IN_S, F_IN_T, G}),
        ((("s",), "u"), {F_IN_S, G}),  # not the neighbour's
        ((("t",), "u"), {F_IN_T}),
        ((("s",), "y"), {G}),  # not what gives the output its value
        ((("t",), "y"), set()),
    ],
)
def test_values_go_into_a_system_by_its_inputs_and_out_of_it_by_its_outputs(
    start: Node, reached: set[tuple[str, ...]]
) -> None:
    assert {each.node[0] for each in nets(OUTER).reached(start, None)} == reached


@pytest.mark.parametrize("kind", ["", 'kind="inout"', 'kind="local"'])
@pytest.mark.parametrize("named", ["u", "y"])
def test_values_pass_connectors_that_have_no_direction(kind: str, named: str) -> None:
    known = {"u": "input", "y": "output"}[named]
    structure = OUTER.replace(f'name="{named}" kind="{known}"', f'name="{named}" {kind}')
    assert {F_IN_S, G} <= {each.node[0] for each in nets(structure).reached((("s",), "u"), None)}
