"""``nodegraph site``: write a static gallery of runs."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_runs
from nodegraph.cli.output import write_file
from nodegraph.errors import NodegraphError
from nodegraph.formatting import number_of, size_text

HELP = "Write a static site: a gallery of runs with their reports, and runs of one study compared."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_runs(parser)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("site"),
        metavar="DIR",
        help="Folder to write to; an earlier site there is replaced (default: %(default)s).",
    )


def site(arguments: Namespace) -> int:
    """Write the site and print its first page."""
    from nodegraph.site.gallery import INDEX, gallery, is_gallery

    out: Path = arguments.out
    if out.exists() and not is_gallery(out) and (not out.is_dir() or any(out.iterdir())):
        raise NodegraphError(f"{out} exists and is not a site; name another folder with --out")
    contents = gallery(arguments.runs)
    for path, content in contents.generated.items():
        write_file(out / path, content)
    for path, file in contents.copied.items():
        write_file(out / path, file.read_bytes())
    size = sum(file.stat().st_size for file in out.rglob("*") if file.is_file())
    print(f"{out / INDEX} ({number_of(contents.runs, 'run')}, {size_text(size)})")
    return 0
