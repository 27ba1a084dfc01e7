"""Everything that a plugin can add: a hook each.

A plugin is a module, named in the entry point group ``nodegraph``, that implements any of these
hooks with `hookimpl`, as functions without arguments whose names begin with ``nodegraph_``. Each is
called once, when its result is first needed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import pluggy

from nodegraph.plugin.hook_types import Command, Format, Viewer
from nodegraph.plugin.kind import Kind

GROUP = "nodegraph"
BUILT_IN = "nodegraph.built_in"
"""The groups of entry points: of plugins, and of what this package itself adds."""
hookimpl = pluggy.HookimplMarker(GROUP)


class Shape(Enum):
    """The form of what a hook returns: items, items by name, or a text."""

    LIST = Iterable
    NAMED = Mapping
    TEXT = str


@dataclass(frozen=True)
class Hook:
    """What one hook of a plugin returns.

    Attributes
    ----------
    shape : Shape
    item : type
        The type of each item.
    doc : str
        The documentation of what the hook returns, for authors of plugins.
    example : str
        The body of a function that implements it.
    """

    shape: Shape
    item: type
    doc: str
    example: str


_FUNCTION: type = Callable  # type: ignore[assignment]  # as isinstance takes it

HOOKS: Mapping[str, Hook] = {
    "nodes": Hook(
        Shape.LIST,
        _FUNCTION,
        "The plugin's nodes: functions decorated with `nodegraph.node`.",
        "from lips.fill import first\nreturn [first]",
    ),
    "node_finders": Hook(
        Shape.NAMED,
        _FUNCTION,
        "For `scheme` in `use: scheme:name`, a function from the name to a node. It returns one "
        "decorated with `nodegraph.node`, whose name the graph's then replaces, and raises "
        "`nodegraph.NodegraphError` for a name of which there is no node.",
        'return {"lips": node_of_model}',
    ),
    "bibtex": Hook(
        Shape.TEXT,
        str,
        'The BibTeX entries that the plugin\'s nodes cite: `@node("fill.lips", cite="lips2026")`.',
        'return "@article{lips2026, title = {Lips}, author = {A. Author}, year = 2026}"',
    ),
    "kinds": Hook(
        Shape.LIST,
        Kind,
        "What the plugin knows of types of values: how they are shown, stored, compared and "
        "streamed, and what a study concludes from them.",
        'return [Kind(Lips, render=late("lips.report:render"), compare=compare_lips)]',
    ),
    "formats": Hook(
        Shape.LIST,
        Format,
        "Formats in which values are read from files: see `nodegraph.formats`.",
        'return [Format("Lips", Lips, (".lips",), read_lips)]',
    ),
    "readers": Hook(
        Shape.NAMED,
        _FUNCTION,
        "For the name of a node that reads files, a function from a path to the name of the file's "
        "format, or to None where the node does not read that file. `nodegraph show FILE` calls "
        "the first node that reads it with the path as the setting `path`.",
        'return {"read.lips": lambda path: "Lips" if path.suffix == ".lips" else None}',
    ),
    "viewers": Hook(
        Shape.LIST,
        Viewer,
        "What shows values of several types together on one page: `nodegraph view FILE...` calls "
        "it with what was read from files, `nodegraph open` with a result that has no renderer.",
        "return [Viewer((Lips,), late('lips.page:view'))]",
    ),
    "contracts": Hook(
        Shape.NAMED,
        Iterable,
        "What every node of a family promises, third-party nodes included.",
        'return {"fill": [leaves_measured_samples_untouched]}',
    ),
    "sources": Hook(
        Shape.NAMED,
        _FUNCTION,
        "For `scheme` in `--source node=scheme:address`, what makes a `Source`. The function takes "
        "the address and connects to nothing yet; it raises `nodegraph.NodegraphError` for an "
        "address that is not valid.",
        'return {"lips": lips_source}',
    ),
    "sinks": Hook(
        Shape.NAMED,
        _FUNCTION,
        "For `scheme` in `--sink node=scheme:address`, what makes a `Sink`, as for sources.",
        'return {"lips": lips_sink}',
    ),
    "executors": Hook(
        Shape.NAMED,
        _FUNCTION,
        "Further ways to compute steps: see `nodegraph.executors.Executor`.",
        'return {"cluster": run_on_cluster}',
    ),
    "places": Hook(
        Shape.NAMED,
        _FUNCTION,
        "For `scheme` in a path `scheme:name`, a function from name to file or folder. It raises "
        "`nodegraph.NodegraphError` for an unknown name.",
        'return {"lips": lambda name: Path("/data/lips") / name}',
    ),
    "graphs": Hook(
        Shape.LIST,
        Path,
        "The example graphs that the plugin ships.",
        'return Path(__file__).parent.glob("graphs/*.yaml")',
    ),
    "templates": Hook(
        Shape.NAMED,
        Path,
        "What `nodegraph new` writes, by kind: `plugin`, `graph`. Each is a folder whose files are "
        "copied with `{{name}}` replaced, in their text and in their paths, and `.template` "
        "removed from the end of their names.",
        'return {"lips": Path(__file__).parent / "templates" / "lips"}',
    ),
    "commands": Hook(
        Shape.NAMED,
        Command,
        "Further commands of the command line. They are looked up for a word that is not a "
        "built-in command, and for `nodegraph help`.",
        'return {"lips": Command("Count lips.", add_arguments, count_lips)}',
    ),
}


def specifications() -> type:
    """Return a class with a function for each hook, as pluggy takes specifications."""
    mark = pluggy.HookspecMarker(GROUP)
    return type("Hooks", (), {f"{GROUP}_{name}": mark(lambda self: None) for name in HOOKS})
