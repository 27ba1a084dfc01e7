"""Axes: those of a graph as the command chooses, those of each node, and their combinations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from math import prod

from nodegraph.errors import Place, Problems, nearest, quoted
from nodegraph.graph.model import Axis, Choices, Gather, GraphNode, Method, sources_of
from nodegraph.graphfile.axes import axis_from_option
from nodegraph.graphfile.spec import AxisSpec, NodeSpec, Reference

MOST_COMBINATIONS = 5_000_000
_MOST_DIGITS = 10**18


def chosen_axis(name: str, spec: AxisSpec | None, choices: Choices, problems: Problems) -> Axis:
    """Return an axis as the file has it, with the labels that the command gives it or leaves.

    Parameters
    ----------
    name
    spec
        None for an input that is an axis by choice.
    choices
    problems
    """
    written = spec.labels if spec is not None else ()
    if spec is None or name in choices.axes:
        folder = choices.folders.get(name, choices.folder)
        spec = axis_from_option(name, choices.axes[name], folder, problems)
    removed = frozenset(written) - frozenset(spec.labels)
    values = dict(zip(spec.labels, spec.values, strict=True))
    return restricted_axis(Axis(name, spec.labels, values, removed), choices, problems)


def restricted_axis(axis: Axis, choices: Choices, problems: Problems) -> Axis:
    """Return an axis with the labels that ``only`` leaves."""
    only = choices.only.get(axis.name)
    if only is None:
        return axis
    place = Place(f"--only {axis.name}")
    if not only:
        problems.add(place, "no label is kept", nearest("", axis.labels))
    for label in only:
        if label not in axis.labels:
            hint = nearest(label, axis.labels)
            if axis.values:  # not those of a node with alternatives
                hint += f"; for other labels, write --axis {axis.name}={label}"
            problems.add(place, f"no label {quoted(label)}", hint)
    labels = tuple(label for label in axis.labels if label in only)
    removed = axis.removed | (frozenset(axis.labels) - frozenset(labels))
    return Axis(axis.name, labels or axis.labels, axis.values, removed)


def node_axes(
    spec: NodeSpec,
    methods: Iterable[Method],
    nodes: Mapping[str, GraphNode],
    order: Iterable[str],
    problems: Problems,
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the axes of a node, and those that it gathers.

    Plain ports and settings give the node their axes. Of a gathering port's source, the axes
    beyond these are gathered; with ``over``, only those that it names, and the rest are the
    node's own.

    Parameters
    ----------
    spec
    methods
        All of them, so that the graph keeps its axes when a command leaves out some.
    nodes
        The nodes that feed it.
    order
        All axes of the graph, in the order in which a node has them.
    problems
        Receives what is wrong in ``over``.
    """
    matched = {spec.name} if spec.has_alternatives else set()
    gatherable: set[str] = set()
    for method in methods:
        matched.update(method.settings.axes)
        for feed in method.inputs.values():
            axes = gatherable if isinstance(feed, Gather) else matched
            for source in sources_of(feed):
                axes.update(free_axes(source, nodes))
    if not matched and not gatherable and spec.over is None:
        return (), ()
    free = gatherable - matched
    gathered = free if spec.over is None else _over(spec, spec.over, matched, free, problems)
    ordered = [name for name in order if name in matched or name in free]
    return (
        tuple(name for name in ordered if name not in gathered),
        tuple(name for name in ordered if name in gathered),
    )


def free_axes(source: Reference, nodes: Mapping[str, GraphNode]) -> tuple[str, ...]:
    """Return the axes of a source that the reference does not fix."""
    node = nodes.get(source.node)
    return tuple(name for name in node.axes if name not in source.at) if node else ()


def check_fixed_axes(
    source: Reference, nodes: Mapping[str, GraphNode], axes: Mapping[str, Axis], problems: Problems
) -> str:
    """Check the axes and labels in ``at``; return a label that the command has removed."""
    node = nodes.get(source.node)
    if node is None:
        return ""
    removed = ""
    for name, label in source.at.items():
        if name not in node.axes:
            hint = partial(nearest, name, node.axes, what=f"axes of {source.node}")
            problems.add(source.place, f"{quoted(source.node)} has no axis {quoted(name)}", hint)
        elif label in axes[name].removed:
            removed = f"{name}={label}"
        elif label not in axes[name].labels and axes[name].labels:
            hint = partial(nearest, label, axes[name].labels, what="labels")
            problems.add(source.place, f"axis {quoted(name)} has no label {quoted(label)}", hint)
    return removed


def _over(
    spec: NodeSpec,
    over: tuple[tuple[str, Place], ...],
    matched: set[str],
    free: set[str],
    problems: Problems,
) -> set[str]:
    for name, place in over:
        if name in matched:
            message = f"{spec.name}: {quoted(name)} is an axis of its plain ports or settings"
            problems.add(place, message, "such an axis is matched and cannot be gathered")
        elif name not in free:
            hint = nearest(name, sorted(free), what="axes that can be gathered")
            problems.add(place, f"{spec.name}: no axis {quoted(name)} to gather", hint)
    return {name for name, _ in over} & free


def check_combinations(
    nodes: Mapping[str, GraphNode], axes: Mapping[str, Axis], problems: Problems
) -> bool:
    """Whether a run can hold all combinations of nodes; else record which node has most of them.

    Where a node gathers more than it has combinations of its own, what it gathers counts.
    """
    sizes = {name: len(axis.labels) for name, axis in axes.items()}

    def count(names: Iterable[str]) -> int:
        return prod(sizes[name] for name in names)

    def gathered(node: GraphNode) -> int:
        if not node.gathered:
            return 1
        sums = (
            sum(
                count(axis for axis in free_axes(source, nodes) if axis in node.gathered)
                for source in gather.sources.values()
            )
            for method in node.methods.values()  # a command may have left out those that gather
            for gather in method.gathers
        )
        return max(sums, default=1)

    counts = {name: count(node.axes) * gathered(node) for name, node in nodes.items()}
    total = sum(counts.values())
    if total <= MOST_COMBINATIONS:
        return True
    node = nodes[max(counts, key=counts.__getitem__)]
    along = (*node.axes, *node.gathered) if gathered(node) > 1 else node.axes
    problems.add(
        node.place,
        f"{node.name}: {_count_text(counts[node.name])} combinations, "
        f"{' x '.join(f'{axis} ({sizes[axis]:,})' for axis in along)}; a graph may have "
        f"{MOST_COMBINATIONS:,}, and this one has {_count_text(total)}",
        "run fewer labels, as with --axis or --only, or leave an axis out",
    )
    return False


def _count_text(count: int) -> str:
    return f"{count:,}" if count < _MOST_DIGITS else "endless"
