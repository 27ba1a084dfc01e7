"""``nodegraph open``: show the report of runs with everything behind it, in a browser."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_page, add_plugin, add_runs
from nodegraph.cli.browser import needing_pages, serve
from nodegraph.errors import NodegraphError

if TYPE_CHECKING:
    from starlette.types import ASGIApp

HELP = "Show the report of runs in a browser, with every result behind it."
MORE = """\
The page is that of report.html, with all that does not fit into a file: every result of the run,
from the store or computed when it is asked for, and other runs side by side. A run, also one in
progress, is shown as its graph with the states of its steps; each card leads to the results of
its node. Only this machine, and the one browser that opens the printed address first, can see
it. Ctrl-C ends it.

example:
  nodegraph open runs/fill
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_runs(parser)
    add_page(parser)
    add_plugin(parser)
    parser.add_argument(
        "--store",
        type=Path,
        metavar="DIR",
        help="Folder of stored results (default: that of the run).",
    )


def open(arguments: Namespace) -> int:
    """Serve runs until the user ends it."""
    from nodegraph.runs.folder import is_run, runs_in

    with needing_pages():
        from nodegraph.serve.server import LocalServer

    for path in arguments.runs:
        if not is_run(path) and not any(runs_in(path)):
            raise NodegraphError(
                f"{path.absolute()}: there is no run; run a graph, or name the folder of a run"
            )

    def application() -> ASGIApp:
        from nodegraph.plugin.registry import Registry
        from nodegraph.serve.app import application
        from nodegraph.serve.runs import OpenRuns

        registry = Registry.installed(arguments.plugin)
        return application(OpenRuns(arguments.runs, registry, arguments.store))

    server = LocalServer(application, arguments.port)
    serve(server, with_browser=arguments.browser)
    return 0
