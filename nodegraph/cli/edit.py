"""``nodegraph edit``: edit a graph file as text and as picture, in a browser."""

from __future__ import annotations

import signal
import sys
from argparse import ArgumentParser, Namespace
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from nodegraph.cli.arguments import add_page, add_plugin, add_store
from nodegraph.cli.browser import needing_pages, serve
from nodegraph.cli.output import say

if TYPE_CHECKING:
    from starlette.types import ASGIApp

    from nodegraph.editor.file import EditedFile

HELP = "Edit a graph file in a browser, as text and as picture."
MORE = """\
The page shows the file beside the picture of its graph, with the mistakes that `nodegraph check`
finds, where they are. Ctrl-S there saves; Ctrl-Enter runs the graph into runs/GRAPH, as `nodegraph
run` does, and shows how far it is. Until it is saved, what is edited is kept beside the file, in
GRAPH.unsaved, with which the next edit begins. Only this machine, and the one browser that opens
the printed address first, can see the page. Ctrl-C ends it.

example:
  nodegraph edit fill.yaml
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "graph", type=Path, metavar="GRAPH", help="Graph file; one that is not there begins empty."
    )
    add_page(parser)
    add_plugin(parser)
    add_store(parser)


def edit(arguments: Namespace) -> int:
    """Serve the page until the user ends it."""
    from nodegraph.editor.file import EditedFile

    with needing_pages():
        from nodegraph.editor.page import MOST_BODY, page
        from nodegraph.serve.server import LocalServer

    file = EditedFile(arguments.graph)
    with ExitStack() as ending:

        def application() -> ASGIApp:
            from nodegraph.cli.graphs import run_folder
            from nodegraph.editor.app import application
            from nodegraph.editor.running import Running
            from nodegraph.plugin.registry import Registry

            registry = Registry.installed(arguments.plugin)
            running = Running(
                arguments.graph, run_folder(arguments), registry, arguments.store, arguments.plugin
            )
            ending.callback(running.end)
            return application(file, registry, running)

        server = LocalServer(
            application, arguments.port, most_body=MOST_BODY, page=lambda: page(file)
        )
        signal.signal(signal.SIGTERM, _end)
        if sys.platform != "win32":
            signal.signal(signal.SIGHUP, _end)  # the terminal has been closed
        ending.callback(_say_whether_saved, file)
        serve(server, with_browser=arguments.browser)
    return 0


def _say_whether_saved(file: EditedFile) -> None:
    if not file.is_saved:
        say(f"not saved; kept in {file.copy}, with which the next edit begins")


def _end(number: int, frame: object) -> NoReturn:
    """End as Ctrl-C does, so that a run does not go on alone."""
    raise SystemExit(128 + number)
