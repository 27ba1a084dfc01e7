"""Arguments that several commands share, and how their values are read."""

from __future__ import annotations

import re
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.errors import NodegraphError

if TYPE_CHECKING:
    from argparse import _ActionsContainer

_METAVARS = {
    "set": "INPUT=VALUE",
    "with": "SETTING=VALUE",
    "axis": "AXIS=LABELS",
    "only": "AXIS=LABELS",
    "at": "AXIS=LABEL",
}


def add_graph(parser: ArgumentParser, text: str = "Graph file.") -> None:
    """Add a graph file and the options that choose among its inputs and labels."""
    parser.add_argument("graph", type=Path, metavar="GRAPH", help=text)
    add_pairs(parser, "set", "Value of an input: --set recording=mine.c3d, --set factor=1.5.")
    add_pairs(
        parser,
        "axis",
        "Labels of an axis, or of an input that becomes one, in place of those in the graph: "
        "--axis order=3,5, --axis 'trial={count: 10}', --axis recording=a.c3d,b.c3d, "
        "--axis 'recording={Ann: a.c3d, Bo: b.c3d}'.",
    )
    add_pairs(
        parser,
        "only",
        "Labels to keep, of an axis or of a node with alternatives: --only fill=muscle,linear "
        "--only length=15.",
    )
    add_plugin(parser)


def add_pairs(parser: ArgumentParser, option: str, text: str) -> None:
    """Add an option ``--set INPUT=VALUE``, which may be repeated."""
    parser.add_argument(
        f"--{option}", action="append", default=[], metavar=_METAVARS[option], help=text
    )


def add_plugin(parser: ArgumentParser) -> None:
    """Add ``--plugin FILE``."""
    parser.add_argument(
        "--plugin",
        action="append",
        default=[],
        type=Path,
        metavar="FILE",
        help="Python file with further nodes.",
    )


def add_page(parser: ArgumentParser) -> None:
    """Add the options of a page that is served."""
    parser.add_argument(
        "--port",
        type=int,
        default=0,
        metavar="N",
        help="Port to use, such as one that ssh -L forwards (default: any that is free).",
    )
    parser.add_argument(
        "--no-browser",
        action="store_false",
        dest="browser",
        help="Print the address and open no browser.",
    )


def add_reading(parser: ArgumentParser) -> None:
    """Add the option that sets what a file does not state."""
    add_pairs(
        parser,
        "with",
        "Setting of the node that reads a file, for what it does not state: --with rate=120, "
        "--with unit=cm.",
    )


def add_run(parser: ArgumentParser) -> None:
    """Add the folder of a run."""
    parser.add_argument("run", type=Path, metavar="RUN", help="Folder of a run, such as runs/fill.")


def add_runs(parser: ArgumentParser) -> None:
    """Add the folders of runs, or folders of these."""
    parser.add_argument(
        "runs",
        nargs="+",
        type=Path,
        metavar="RUN",
        help="Folder of a run, such as runs/fill, or a folder of runs.",
    )


def add_executor(parser: ArgumentParser) -> None:
    """Add the options that say where steps are computed."""
    parser.add_argument(
        "--jobs",
        type=int,
        metavar="N",
        help="Number of steps at a time (default: number of processors).",
    )
    parser.add_argument(
        "--executor",
        default="",
        metavar="NAME",
        help="threads, serial, processes, dask, or a plugin's (default: threads; processes with "
        "--timeout or --memory).",
    )
    parser.add_argument(
        "--scheduler", default="", metavar="ADDRESS", help="Address of a Dask scheduler."
    )
    parser.add_argument(
        "--timeout",
        type=float,
        metavar="SECONDS",
        help="A step that takes longer fails; the others continue.",
    )
    parser.add_argument(
        "--memory",
        type=float,
        metavar="GB",
        help="A step that takes more memory fails; in processes, on Linux.",
    )


def add_store(parser: ArgumentParser) -> None:
    """Add ``--store DIR``."""
    parser.add_argument(
        "--store",
        type=Path,
        metavar="DIR",
        help="Folder of stored results (default: NODEGRAPH_STORE, or the user's cache folder).",
    )


def add_json(parser: _ActionsContainer) -> None:
    """Add ``--json``."""
    parser.add_argument(
        "--json",
        action="store_true",
        help="Print the answer as JSON; `nodegraph schema COMMAND` describes it.",
    )


def pairs(arguments: Namespace, option: str) -> dict[str, str]:
    """Return the texts of an option ``--set INPUT=VALUE`` by their names."""
    return _split(option, getattr(arguments, option))


def values_of(arguments: Namespace, option: str) -> dict[str, object]:
    """Return the values of an option ``--set`` or ``--with`` by their names."""
    from nodegraph.graph.option_text import read_value

    texts = pairs(arguments, option)
    return {name: read_value(f"--{option} {name}", text) for name, text in texts.items()}


def labels_at(arguments: Namespace) -> dict[str, str]:
    """Return the labels of ``--at``: one for each axis, repeated or joined by commas."""
    words = (part for word in arguments.at for part in re.split(r",(?=[^,=]+=)", word))
    return _split("at", words)


def _split(option: str, words: Iterable[str]) -> dict[str, str]:
    texts: dict[str, str] = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not name:
            raise NodegraphError(f"--{option} {word}: write --{option} {_METAVARS[option]}")
        if name in texts:
            raise NodegraphError(f"--{option} {name} is given twice")
        texts[name] = text
    return texts
