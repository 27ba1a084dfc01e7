"""Everything that a plugin can add: a hook each.

A plugin is a module, named in the entry point group ``nodegraph``, that implements any of these
hooks with `hookimpl`. Each is called once, when its result is first needed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import pluggy

from nodegraph.plugin.hook_types import (
    Command,
    Comparison,
    Conclusion,
    Contract,
    Detail,
    Format,
    Renderer,
    Storage,
)
from nodegraph.plugin.streaming import LiveView, Sink, Source, Streamable

GROUP = "nodegraph"
BUILT_IN = "nodegraph.built_in"
"""The groups of entry points: of plugins, and of what this package itself adds."""
hookspec = pluggy.HookspecMarker(GROUP)
hookimpl = pluggy.HookimplMarker(GROUP)


@hookspec
def nodegraph_nodes() -> Iterable[Callable[..., object]]:  # type: ignore[empty-body]
    """Return the plugin's nodes: functions decorated with `nodegraph.node`.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_nodes():
    ...     from lips.fill import first
    ...     return [first]
    """


@hookspec
def nodegraph_node_finders() -> Mapping[str, Callable[[str], Callable[..., object]]]:  # type: ignore[empty-body]
    """Return, for ``scheme`` in ``use: scheme:name``, a function from the name to a node.

    The function returns one decorated with `nodegraph.node`, whose name the graph's then
    replaces, and raises `nodegraph.NodegraphError` for a name of which there is no node.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_node_finders():
    ...     return {"lips": node_of_model}
    """


@hookspec
def nodegraph_bibtex() -> str:  # type: ignore[empty-body]
    """Return the BibTeX entries that the plugin's nodes cite.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_bibtex():
    ...     return "@article{lips2026, title = {Lips}, author = {A. Author}, year = 2026}"
    """


@hookspec
def nodegraph_renderers() -> Iterable[Renderer]:  # type: ignore[empty-body]
    """Return how values of the plugin's types appear in a report.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_renderers():
    ...     def render(lips, title):
    ...         return Rendered(html=f"<p>{lips.width:.1f} mm</p>")
    ...     return [Renderer(Lips, render)]
    """


@hookspec
def nodegraph_details() -> Iterable[Detail]:  # type: ignore[empty-body]
    """Return how single blocks of a comparison are shown, by what their scores were given.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_details():
    ...     return [Detail(Lips, pack_block, lambda inputs, column: None, "lips/block")]
    """


@hookspec
def nodegraph_comparisons() -> Iterable[Comparison]:  # type: ignore[empty-body]
    """Return how the differences of values of the plugin's types are described.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_comparisons():
    ...     def compare(first, second):
    ...         yield f"width {second.width - first.width:+.1f} mm"
    ...     return [Comparison(Lips, compare)]
    """


@hookspec
def nodegraph_conclusions() -> Iterable[Conclusion]:  # type: ignore[empty-body]
    """Return what a study concludes from values of the plugin's types.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_conclusions():
    ...     def conclude(lips):
    ...         yield f"the lips are {'open' if lips.width else 'closed'}"
    ...     return [Conclusion(Lips, conclude, lambda lips: f"width,{lips.width}")]
    """


@hookspec
def nodegraph_storages() -> Iterable[Storage]:  # type: ignore[empty-body]
    """Return how values of the plugin's types are stored.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_storages():
    ...     return [Storage(Spline, lambda spline: spline.tck, lambda tck: Spline(*tck))]
    """


@hookspec
def nodegraph_formats() -> Iterable[Format]:  # type: ignore[empty-body]
    """Return how values are read from files: see `nodegraph.formats`.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_formats():
    ...     return [Format("Lips", Lips, (".lips",), read_lips)]
    """


@hookspec
def nodegraph_streamables() -> Iterable[Streamable]:  # type: ignore[empty-body]
    """Return how values of the plugin's types are split into frames, to be streamed.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_streamables():
    ...     return [Streamable(Lips, without_frames, split_lips, join_lips, missing_lips)]
    """


@hookspec
def nodegraph_live_views() -> Iterable[LiveView]:  # type: ignore[empty-body]
    """Return how values of the plugin's types appear on the page of a stream.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_live_views():
    ...     return [LiveView(Lips, begin_lips, pack_lips, "lips/live")]
    """


@hookspec
def nodegraph_sources() -> Mapping[str, Callable[[str], Source]]:  # type: ignore[empty-body]
    """Return, for ``scheme`` in ``--source node=scheme:address``, what makes a `Source`.

    The function takes the address and connects to nothing yet; it raises
    `nodegraph.NodegraphError` for an address that is not valid.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_sources():
    ...     return {"lips": lips_source}
    """


@hookspec
def nodegraph_sinks() -> Mapping[str, Callable[[str], Sink]]:  # type: ignore[empty-body]
    """Return, for ``scheme`` in ``--sink node=scheme:address``, what makes a `Sink`.

    The function takes the address and connects to nothing yet; it raises
    `nodegraph.NodegraphError` for an address that is not valid.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_sinks():
    ...     return {"lips": lips_sink}
    """


@hookspec
def nodegraph_executors() -> Mapping[str, Callable[..., object]]:  # type: ignore[empty-body]
    """Return further ways to compute steps, by name: see `nodegraph.executors.Executor`.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_executors():
    ...     return {"cluster": run_on_cluster}
    """


@hookspec
def nodegraph_places() -> Mapping[str, Callable[[str], Path]]:  # type: ignore[empty-body]
    """Return, for ``scheme`` in a path ``scheme:name``, a function from name to file or folder.

    The function raises `nodegraph.NodegraphError` for an unknown name.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_places():
    ...     return {"lips": lambda name: Path("/data/lips") / name}
    """


@hookspec
def nodegraph_graphs() -> Iterable[Path]:  # type: ignore[empty-body]
    """Return the example graphs that the plugin ships.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_graphs():
    ...     return Path(__file__).parent.glob("graphs/*.yaml")
    """


@hookspec
def nodegraph_templates() -> Mapping[str, Path]:  # type: ignore[empty-body]
    """Return what ``nodegraph new`` writes, by kind: ``plugin``, ``graph``.

    Each is a folder whose files are copied with ``{{name}}`` replaced, in their text and in their
    paths, and ``.template`` removed from the end of their names.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_templates():
    ...     return {"lips": Path(__file__).parent / "templates" / "lips"}
    """


@hookspec
def nodegraph_commands() -> Mapping[str, Command]:  # type: ignore[empty-body]
    """Return further commands of the command line, by name.

    They are looked up for a word that is not a built-in command, and for ``nodegraph help``.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_commands():
    ...     return {"lips": Command("Count lips.", add_arguments, count_lips)}
    """


@hookspec
def nodegraph_specimens() -> Mapping[type, Callable[[], Mapping[str, object]]]:  # type: ignore[empty-body]
    """Return, for each of the plugin's types, a function that makes small values to test nodes on.

    Each value has a name; values of several types that have the same name belong together.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_specimens():
    ...     return {Lips: lambda: {"closed": Lips(0.0), "open": Lips(9.0)}}
    """


@hookspec
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:  # type: ignore[empty-body]
    """Return what every node of a family promises, third-party nodes included.

    Examples
    --------
    >>> @hookimpl
    ... def nodegraph_contracts():
    ...     return {"fill": [leaves_measured_samples_untouched]}
    """
