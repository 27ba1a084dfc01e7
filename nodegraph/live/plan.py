"""The part of a graph that runs on a stream, in its order, with the delay of each step."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Literal, get_args, get_origin

from nodegraph.errors import NodegraphError, Place, Problems, listed, nearest
from nodegraph.graph import Choices, Graph, build
from nodegraph.node.decorator import Node
from nodegraph.node.description import value_text
from nodegraph.node.live_form import RunningForm, StateForm
from nodegraph.node.ports import Across, Label
from nodegraph.plan import Output, Plan, Step, StepInput, outputs_in, plan

_WHOLE_TAKE = "needs the whole take"
_NO_BOUND = "looks ahead without bound"
_FRAMES = (1, 30)
"""Numbers that are tried to find a setting that bounds a look-ahead."""


@dataclass(frozen=True)
class LiveStep:
    """One method that runs on the stream.

    Attributes
    ----------
    step : Step
    lookahead : int
        How many frames after a frame its result needs.
    behind : int
        How many frames later than the source's its result is: along the slowest of its inputs.
    streams : mapping of port to Output
        The sources of the ports that take frames.
    values : mapping of port to Output
        The sources of the other ports, computed once.
    """

    step: Step
    lookahead: int
    behind: int
    streams: Mapping[str, Output]
    values: Mapping[str, Output]


@dataclass(frozen=True)
class LivePlan:
    """The part of a graph that runs on a stream.

    Attributes
    ----------
    plan : Plan
        The plan of the whole graph, or of what the sinks need.
    source : Output
        Whose value the stream replaces.
    steps : tuple of LiveStep
        Each after those that feed it.
    cut_off : mapping of node to reason
        Nodes that depend on the stream and do not run on it.
    """

    plan: Plan
    source: Output
    steps: tuple[LiveStep, ...]
    cut_off: Mapping[str, str]

    @property
    def held(self) -> tuple[Step, ...]:
        """The steps that are computed once, before the stream begins."""
        needed = {output.step for step in self.steps for output in step.values.values()}
        return tuple(self.plan.steps[index] for index in sorted(needed))

    @property
    def running(self) -> Mapping[Output, RunningForm]:
        """The outputs in whose place numbers are kept current."""
        return {
            Output(live.step.index, 0): form
            for live in self.steps
            if isinstance(form := live.step.method.node.live, RunningForm)
        }

    def paths(self) -> Iterator[tuple[LiveStep, ...]]:
        """Yield for each step that no other reads the slowest way to it from the source."""
        by_index = {step.step.index: step for step in self.steps}
        read = {output.step for step in self.steps for output in step.streams.values()}
        for last in self.steps:
            if last.step.index in read:
                continue
            path = [last]
            while before := [
                by_index[output.step]
                for output in path[0].streams.values()
                if output.step in by_index
            ]:
                path.insert(0, max(before, key=lambda step: step.behind))
            yield tuple(path)

    def outputs(self, name: str) -> Mapping[Output, Mapping[str, Label]]:
        """Return the streamed outputs that a sink's name means, with the labels that differ.

        Parameters
        ----------
        name
            A node, or one of its outputs: ``gaps.truth``.

        Raises
        ------
        NodegraphError
            If it does not run on the stream.
        """
        graph = self.plan.graph
        node, port = split_name(graph, name)
        source = self.plan.steps[self.source.step]
        if source.node == node and _position(source, port) == self.source.position:
            return {self.source: {}}
        steps = [step.step for step in self.steps if step.step.node == node]
        if not steps:
            reason = self.cut_off.get(node, "it does not depend on the stream")
            raise NodegraphError(f"{name}: {reason}")
        varying = [
            axis for axis in steps[0].labels if len({step.labels.get(axis) for step in steps}) > 1
        ]
        outputs = {
            Output(step.index, _position(step, port)): {axis: step.labels[axis] for axis in varying}
            for step in steps
        }
        for output in outputs:
            if reason := not_given(self.plan, output):
                raise NodegraphError(f"a sink cannot take {reason}")
        return outputs


def live_plan(
    graph: Graph,
    source: str,
    *,
    sinks: Collection[str] = (),
    hold: Collection[str] = (),
) -> LivePlan:
    """Return the part of a graph that runs on a stream.

    Parameters
    ----------
    graph
    source
        The place where the stream enters: a node without inputs, one of its outputs, or the input
        or the axis that chooses what such a node reads. By default the only one that a node with a
        live form reads.
    sinks
        Nodes, or outputs, whose frames are computed; by default all that are possible.
    hold
        Nodes that are computed once, from what the graph itself reads, although they depend on
        what the stream replaces.

    Raises
    ------
    GraphError
        If a look-ahead is unbounded, an axis has several labels, or what a sink needs cannot run
        on the stream.
    NodegraphError
        If a name is not known.
    """
    node, port = _source_of(graph, source)
    if source in graph.axes and source not in graph.nodes:
        first = graph.axes[source].labels[:1]  # the stream is the data, whatever the label
        choices = graph.choices.updated(Choices(only={source: first}, folder=graph.choices.folder))
        graph = build(graph.spec, graph.registry, choices)
    for name in hold:
        split_name(graph, name)
    if sinks:
        graph = graph.until([*(split_name(graph, name)[0] for name in sinks), node])
    planned = plan(graph)
    return _Planner(planned, node, port, frozenset(hold), frozenset(sinks)).plan()


def split_name(graph: Graph, name: str) -> tuple[str, str]:
    """Return the node and the output that a name means; an empty output is the first.

    Raises
    ------
    NodegraphError
        If there is none.
    """
    node, port = (name, "") if name in graph.nodes else name.rpartition(".")[::2]
    if node not in graph.nodes:
        reason = graph.reasons_left_out().get(name)
        hint = f"it is left out: {reason}" if reason else nearest(name, graph.nodes)
        raise NodegraphError(f"the graph has no node {name!r}; {hint}")
    outputs = graph.nodes[node].outputs
    if port and port not in outputs:
        raise NodegraphError(f"{node!r} has no output {port!r}; {nearest(port, outputs)}")
    return node, port


def not_given(planned: Plan, output: Output) -> str:
    """Return which output of a live form is not given, or an empty text for one that is."""
    step = planned.steps[output.step]
    form, port = step.method.node.live, step.method.node.outputs[output.position].name
    if isinstance(form, StateForm) and form.outputs and port not in form.outputs:
        return f"{step.node}.{port}, which only a whole take has"
    return ""


def bounding_settings(node: Node, settings: Mapping[str, object]) -> str:
    """Return the settings that would bound a node's look-ahead: ``max_gap: 30``; empty if none."""
    options = [
        (name, choice)
        for name, setting in node.settings.items()
        for choice in _choices(setting.annotation)
        if choice != settings[name]
    ]
    for count in (1, 2):
        for several in combinations(options, count):
            changed = {**settings, **dict(several)}
            if len(dict(several)) == count and node.live_lookahead(changed) is not None:
                return ", ".join(f"{name}: {value_text(value)}" for name, value in several)
    return ""


def _choices(kind: object) -> tuple[object, ...]:
    """Return values of a type that may bound a look-ahead."""
    if get_origin(kind) is Literal:
        return get_args(kind)
    if kind is bool:
        return (True, False)
    if kind is int:
        return _FRAMES
    return tuple(choice for each in get_args(kind) for choice in _choices(each))


def _source_of(graph: Graph, name: str) -> tuple[str, str]:
    """Return the node and the output that a stream replaces."""
    candidates = {
        (source, output)
        for source, target, wire in graph.wires()
        for output in [wire.output]
        if not graph.network.in_degree(source)
        and any(wire.port in method.node.streams for method in graph.nodes[target].methods.values())
    }
    if name and (name in graph.nodes or name.rpartition(".")[0] in graph.nodes):
        node, port = split_name(graph, name)
        if graph.network.in_degree(node):
            raise NodegraphError(
                f"{node!r} is computed from other nodes; a stream replaces one without inputs: "
                f"{listed(sorted({source for source, _ in candidates}))}"
            )
        return node, port
    if name:
        if name not in graph.axes and name not in graph.inputs:
            known = [*graph.nodes, *graph.inputs, *graph.axes]
            raise NodegraphError(
                f"the graph has no node, input or axis {name!r}; {nearest(name, known)}"
            )
        candidates = {each for each in candidates if name in _variables(graph, each[0])}
    names = sorted({f"{source}.{output}" for source, output in candidates})
    if len(names) != 1:
        raise NodegraphError(_ambiguous(graph, name, names))
    ((source, output),) = candidates
    return source, output


def _ambiguous(graph: Graph, name: str, outputs: Collection[str]) -> str:
    """Return why a name does not say what a stream replaces."""
    if outputs:
        several = f"{listed(outputs)}; name the output of one node"
        return f"{name!r} feeds {several}" if name else f"a stream could replace {several}"
    reads = {
        target: graph.nodes[target].first.node
        for source, target, _ in graph.wires()
        if not graph.network.in_degree(source) and (not name or name in _variables(graph, source))
    }
    whole = {reader: node for reader, node in reads.items() if node.live is None}
    hints = filter(None, dict.fromkeys(_live_relatives(graph, node) for node in whole.values()))
    uses = listed(f"{reader} ({node.name})" for reader, node in whole.items())
    why = "; ".join([f"what reads it first needs the whole take: {uses}", *hints])
    what = f"{name!r} cannot be a stream" if name else "no stream can feed the graph"
    return f"{what}: {why if whole else 'no node takes frames from it'}"


def _live_relatives(graph: Graph, node: Node) -> str:
    """Return which nodes of the family run on a stream, and take and give the same, as a hint."""
    takes = {port.type for port in node.inputs}
    family = graph.registry.family(node.family).values()
    names = [
        each.node.name
        for each in family
        if each.node.live is not None
        and each.node.outputs[0].type == node.outputs[0].type
        and takes.issuperset(port.type for port in each.node.inputs if not port.optional)
    ]
    return (
        f"in place of {node.name}, use one that runs on a stream: {listed(names)}" if names else ""
    )


def _variables(graph: Graph, node: str) -> set[str]:
    """Return the inputs and axes that a node's settings name."""
    spec = graph.spec.nodes[node]
    settings = [spec.settings, *(method.settings for method in spec.methods)]
    return {
        variable.name
        for each in settings
        for written in each.values()
        for variable in written.variables()
    }


def _position(step: Step, port: str) -> int:
    return [each.name for each in step.method.node.outputs].index(port) if port else 0


class _Planner:
    def __init__(
        self, planned: Plan, node: str, port: str, hold: frozenset[str], sinks: frozenset[str]
    ) -> None:
        self._plan = planned
        self._hold = hold
        self._sinks = sinks
        self._problems = Problems()
        hooks = planned.graph.registry.hooks
        self._streamable = tuple(kind.type for kind in hooks.having("stream"))
        step = planned.steps[next(iter(planned.cells[node].values()))]
        self._source = Output(step.index, _position(step, port))
        self._node = node
        self._live: dict[int, LiveStep] = {}
        self._cut: dict[int, str] = {}

    def plan(self) -> LivePlan:
        for step in self._plan.steps:
            if step.node not in self._hold and (tainted := self._from_stream(step)):
                reason = self._add(step, tainted)
                if reason:
                    self._cut[step.index] = reason
        self._check_axes()
        self._check_sinks()
        if not self._live and not self._sinks:
            cut = {self._plan.steps[index].node: reason for index, reason in self._cut.items()}
            reasons = listed(f"{node}: {reason}" for node, reason in cut.items())
            first = next(iter(self._cut), None)
            if first is not None and self._cut[first] == _WHOLE_TAKE:
                hint = _live_relatives(self._plan.graph, self._plan.steps[first].method.node)
                reasons = f"{reasons}; {hint}" if hint else reasons
            place = self._plan.graph.nodes[self._node].place
            self._problems.add(place, "nothing of the graph runs on a stream", reasons)
        self._problems.raise_any()
        cut_off: dict[str, str] = {}
        for index, reason in self._cut.items():
            cut_off.setdefault(self._plan.steps[index].node, reason)
        return LivePlan(self._plan, self._source, tuple(self._live.values()), cut_off)

    def _from_stream(self, step: Step) -> list[str]:
        """Return the ports of a step that depend on the stream."""
        return [
            port
            for port, feed in step.inputs.items()
            if any(
                each == self._source or each.step in self._live or each.step in self._cut
                for each in outputs_in([feed])
            )
        ]

    def _add(self, step: Step, ports: Collection[str]) -> str:
        """Add a step that depends on the stream, or return why it cannot run there."""
        obstacle = self._obstacle(step, ports)
        if obstacle:
            return obstacle
        node = step.method.node
        lookahead = node.live_lookahead(step.settings)
        if lookahead is None:
            self._refuse(step)
            return _NO_BOUND
        feeds = {port: feed for port, feed in step.inputs.items() if isinstance(feed, Output)}
        streams = {port: feed for port, feed in feeds.items() if port in ports}
        values = {port: feed for port, feed in feeds.items() if port not in ports}
        behind = max(map(self._behind, streams.values()))
        self._live[step.index] = LiveStep(step, lookahead, behind + lookahead, streams, values)
        return ""

    def _obstacle(self, step: Step, ports: Collection[str]) -> str:
        """Return why a step with these ports on the stream cannot run there, or nothing."""
        node = step.method.node
        for port in ports:
            for output in outputs_in([step.inputs[port]]):
                if reason := self._unavailable(output):
                    return f"needs {reason}"
        if node.live is None:
            return _WHOLE_TAKE
        gathering = [port for port, feed in step.inputs.items() if isinstance(feed, Across)]
        whole = [port for port in ports if port not in node.streams]
        still = [port for port in node.streams if port in step.inputs and port not in ports]
        without_frames = [port for port in ports if not self._has_frames(step.inputs[port])]
        for affected, why in (
            (gathering, "gathers"),
            (whole, "takes a whole take"),
            (still, "is not on the stream"),
            (without_frames, "takes what is not given frame by frame"),
        ):
            if affected:
                return f"has a port {affected[0]!r} that {why}"
        return ""

    def _has_frames(self, feed: StepInput) -> bool:
        """Whether what feeds a port is of a type that is split into frames, and given as such."""
        nodes = [
            (self._plan.steps[each.step].method.node, each.position) for each in outputs_in([feed])
        ]
        return all(
            issubclass(node.outputs[position].type, self._streamable)
            and not isinstance(node.live, RunningForm)
            for node, position in nodes
        )

    def _unavailable(self, output: Output) -> str:
        """Return the kind of an output without frames; empty if it has some, or is not a stream."""
        if output.step in self._cut:
            return self._plan.steps[output.step].node
        return not_given(self._plan, output) if output.step in self._live else ""

    def _behind(self, output: Output) -> int:
        return 0 if output == self._source else self._live[output.step].behind

    def _refuse(self, step: Step) -> None:
        hint = bounding_settings(step.method.node, step.settings)
        instead = f"set {hint}" if hint else "use a method with a bounded look-ahead"
        alternatives = [axis for axis in step.labels if axis == step.node]
        if alternatives:
            instead += f", or leave it out with --only {step.node}=..."
        message = (
            f"{step.name}: {step.method.node.name} looks ahead without bound, as no stream can"
        )
        self._problems.add(step.method.place, message, instead)

    def _check_axes(self) -> None:
        """Note axes along which there would be several streams."""
        graph = self._plan.graph
        cells = self._plan.cells[self._node].values()
        steps = [self._plan.steps[index] for index in (*cells, *self._live)]
        for name, axis in graph.axes.items():
            if name in graph.nodes and name != self._node:  # alternatives run side by side
                continue
            labels = {step.labels[name] for step in steps if name in step.labels}
            if len(labels) > 1:
                self._problems.add(
                    self._place_of_axis(name),
                    f"{name!r} has {len(axis.labels)} labels, and there is one stream",
                    f"choose with --only {name}={axis.labels[0]}",
                )

    def _check_sinks(self) -> None:
        for name in sorted(self._sinks):
            node, _ = split_name(self._plan.graph, name)
            for index in dict.fromkeys(self._plan.cells[node].values()):
                step = self._plan.steps[index]
                way = self._way_to_cut(index)
                if index in self._cut and self._cut[index] != _NO_BOUND:
                    needed = (f"needs {self._plan.steps[each].node}, which " for each in way[1:])
                    reason = f"it {''.join(needed)}{self._cut[way[-1]]}"
                elif index in self._cut or index in self._live or index == self._source.step:
                    continue
                else:
                    reason = "it does not depend on the stream"
                message = f"{step.node} cannot run on the stream: {reason}"
                first = self._plan.steps[way[-1]].method.node
                hint = _live_relatives(self._plan.graph, first) if first.live is None else ""
                self._problems.add(step.method.place, message, hint)

    def _way_to_cut(self, index: int) -> list[int]:
        """Return a step and those that cut it off, each fed by the next, back to the first."""
        way = [index]
        while feeding := [
            output.step
            for output in outputs_in(self._plan.steps[way[-1]].inputs.values())
            if output.step in self._cut
        ]:
            way.append(feeding[0])
        return way

    def _place_of_axis(self, name: str) -> Place:
        spec = self._plan.graph.spec
        return spec.axes[name].place if name in spec.axes else Place(f"--axis {name}")
