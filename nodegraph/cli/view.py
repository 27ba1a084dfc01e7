"""``nodegraph view``: show what files hold, in a browser."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from nodegraph.cli.arguments import add_page, add_plugin, add_reading, values_of
from nodegraph.cli.browser import needing_pages, serve

HELP = "Show what files hold in a browser, several of them together."
MORE = """\
Each file is read by the node that reads its format, and the page says what `nodegraph show FILE`
prints: rate, length, gaps, and what reading it had to guess. Samples of a recording are marked
there by hand; the marks are kept beside it, in FILE.marks.csv, and FILE stays as it is. Only this
machine, and the one browser that opens the printed address first, can see the page. Ctrl-C ends it.

example:
  nodegraph view take.c3d cleaned.c3d
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "files",
        nargs="+",
        metavar="FILE",
        help="File, such as take.c3d, or a folder that holds one.",
    )
    add_reading(parser)
    add_page(parser)
    add_plugin(parser)


def view(arguments: Namespace) -> int:
    """Read files and serve their page until the user ends it."""
    from nodegraph.execute.read_files import read_files
    from nodegraph.plugin.registry import Registry

    with needing_pages():
        from nodegraph.serve.files import MOST_BODY, application_of_files
        from nodegraph.serve.server import LocalServer

    registry = Registry.installed(arguments.plugin, nodes_with="readers")
    files = read_files(arguments.files, registry, values_of(arguments, "with"))
    server = LocalServer(
        lambda: application_of_files(files, registry), arguments.port, most_body=MOST_BODY
    )
    serve(server, with_browser=arguments.browser)
    return 0
