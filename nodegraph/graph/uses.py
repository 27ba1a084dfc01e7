"""One node that uses a graph: does what it feeds and sets fit what the graph asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.hands_on import HandsOn, graph_node
from nodegraph.graph.methods import shared_and_own
from nodegraph.graph.placed import field_of, unfolds_too_far, written_in
from nodegraph.graph.subgraph import Subgraph
from nodegraph.spec.parts import (
    Gathering,
    MethodSpec,
    NodeSpec,
    Reference,
    Variable,
    Wiring,
    Written,
)


@dataclass(frozen=True)
class Use:
    """A node, or one of its alternatives, that uses a graph.

    Attributes
    ----------
    node : NodeSpec
    method : MethodSpec
    graph : Subgraph
    """

    node: NodeSpec
    method: MethodSpec
    graph: Subgraph

    @property
    def where(self) -> str:
        """What it is called in messages."""
        label = self.method.label
        return f"{self.node.name} ({label})" if label else self.node.name

    @property
    def prefix(self) -> str:
        """What comes before the names of nodes and axes inside."""
        label = self.method.label
        return f"{self.node.name}.{label}." if label else f"{self.node.name}."

    @property
    def wiring(self) -> Wiring:
        """What feeds the graph's ports; shared wires included."""
        return shared_and_own(self.node, self.method, self.stand_in(*self.graph.outputs))

    @property
    def settings(self) -> Mapping[str, Written]:
        """What the graph's other inputs are given; shared settings included."""
        return {**self.node.settings, **self.method.settings}

    def stand_in(self, *outputs: str) -> HandsOn:
        """Return what hands on some of the graph's outputs."""
        ports = tuple(self.graph.outputs[name] for name in outputs)
        asks = tuple(self.graph.asks.values())
        offers = tuple(self.graph.outputs)
        return graph_node(self.method.use, self.graph.spec.title, asks, ports, offers)


def fits(use: Use, problems: Problems) -> bool:
    """Whether a graph can be put in the place of what uses it; note why not."""
    found = Problems()
    _Check(use, found).check()
    for one in found.all():
        problems.add(one.place, one.message, one.instead)
    return use.graph.is_whole and not found


class _Check:
    def __init__(self, use: Use, problems: Problems) -> None:
        self._use = use
        self._graph = use.graph
        self._name = use.method.use
        self._problems = problems

    def check(self) -> None:
        if not self._graph.spec.outputs:
            message = f"{self._use.where}: {self._name} has no 'outputs': nothing comes out of it"
            self._problems.add(
                self._use.method.place, message, "write there: outputs: {name: node}"
            )
        for name, fed in self._use.wiring.items():
            self._check_port(name, fed)
        self._check_open_ports()
        for name, written in self._use.settings.items():
            self._check_setting(name, written)
        if self._graph.is_whole:
            self._check_effects()
            self._check_fields()
            self._check_extent()

    def _check_port(self, name: str, fed: Reference | Gathering) -> None:
        port = self._graph.asks.get(name)
        if port is None:
            what = f"no input port {name!r}" if name else "no input port"
            hint = nearest(name, self._graph.asks, what="ports")
            if name in self._graph.spec.inputs:
                hint = f"it is a setting: with: {{{name}: value}}"
            self._note(fed.place, f"{self._name} has {what}", hint)
        elif isinstance(fed, Gathering) and not port.across:
            message = f"port {name!r} takes one value, not a mapping of several"
            self._note(fed.place, message, f"inside, ${name} feeds ports that do not gather")

    def _check_open_ports(self) -> None:
        for name, port in self._graph.asks.items():
            if name not in self._use.wiring:
                message = f"port {name}: {port.type.__name__} of {self._name} is not fed"
                self._note(self._use.method.place, message, f"write in: {{{name}: node}}")

    def _check_setting(self, name: str, written: Written) -> None:
        if name in self._graph.spec.inputs:
            return
        hint = nearest(name, self._graph.spec.inputs, what="settings")
        if name in self._graph.asks:
            hint = f"it is a port: in: {{{name}: node}}"
        self._note(written.place, f"{self._name} has no setting {name!r}", hint)

    def _check_effects(self) -> None:
        read = {one.name for one in self._read}
        for name, written in self._use.settings.items():
            if name in self._graph.spec.inputs and name not in read:
                message = f"setting {name!r} of {self._name} leads to none of its outputs"
                self._note(written.place, message, "leave it out: it would change nothing")

    def _check_fields(self) -> None:
        """Check that what is given has the fields that are taken of it inside."""
        for variable in (one for one in self._read if one.name in self._use.settings):
            given = self._use.settings[variable.name]
            try:
                field_of(given.value, variable.field)
            except KeyError:
                fields = list(given.value) if isinstance(given.value, dict) else []
                message = f"setting {variable.name!r} of {self._name} needs {variable.field!r}"
                self._note(given.place, message, nearest(variable.field, fields, what="fields"))

    def _check_extent(self) -> None:
        if unfolds_too_far(self._graph.spec, self._use.settings):
            message = f"with these settings, those inside {self._name} become endless"
            instead = "each of several graphs puts what it is given into a list or mapping again"
            self._note(self._use.method.place, message, instead)

    @cached_property
    def _read(self) -> list[Variable]:
        """The inputs that are read inside."""
        inside = written_in(self._graph.spec.nodes.values())
        return list(dict.fromkeys(one for written in inside for one in written.variables()))

    def _note(self, place: Place, message: str, instead: str) -> None:
        self._problems.add(place, f"{self._use.where}: {message}", instead)
