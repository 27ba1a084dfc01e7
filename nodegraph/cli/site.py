"""``nodegraph site``: write a static site of what is installed and of runs."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import write_file
from nodegraph.errors import NodegraphError
from nodegraph.formatting import size_text

HELP = "Write a static site: gallery of studies and runs, tutorial, reference."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "runs", nargs="*", type=Path, metavar="RUN", help="Folder of a run, such as runs/fill."
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("site"),
        metavar="DIR",
        help="Folder to write to; an earlier site there is replaced (default: %(default)s).",
    )
    add_plugin(parser)


def site(arguments: Namespace) -> int:
    """Write the site and print its first page."""
    from nodegraph.cli.main import all_parsers
    from nodegraph.plugin.registry import Registry
    from nodegraph.site.build import INDEX, site_files

    out: Path = arguments.out
    if out.exists() and not (out / INDEX).is_file() and (not out.is_dir() or any(out.iterdir())):
        raise NodegraphError(f"{out} exists and is not a site; name another folder with --out")
    registry = Registry.installed(arguments.plugin)
    contents = site_files(registry, all_parsers(registry), arguments.runs)
    for path, content in contents.generated.items():
        write_file(out / path, content)
    for path, file in contents.copied.items():
        write_file(out / path, file.read_bytes())
    pages = sum(path.endswith(".html") for path in contents.generated)
    size = sum(file.stat().st_size for file in out.rglob("*") if file.is_file())
    print(f"{out / 'index.html'} ({pages} pages, {size_text(size)})")
    return 0
