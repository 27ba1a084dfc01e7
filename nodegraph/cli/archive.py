"""``nodegraph archive``: pack a run into one file."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_run
from nodegraph.cli.output import refuse_unwritable, say, write_and_print
from nodegraph.errors import NodegraphError
from nodegraph.formatting import number_of
from nodegraph.state import State

HELP = "Pack a run, and everything needed to run it again, into one file."
_SUFFIX = ".zip"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.description = f"{HELP} The file is a Workflow Run RO-Crate."
    add_run(parser)
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="File to write (default: RUN.zip)."
    )
    parser.add_argument(
        "--lock",
        type=Path,
        metavar="FILE",
        help="Lock to include (default: GRAPH.lock next to the graph, if it exists).",
    )
    parser.add_argument(
        "--no-inputs",
        action="store_false",
        dest="inputs",
        help="Include only the SHA-256 of the files that the run read.",
    )


def archive(arguments: Namespace) -> int:
    """Pack a run into one file."""
    from nodegraph.archive.collect import contents_of
    from nodegraph.archive.contents import packed
    from nodegraph.archive.rocrate import crate_metadata
    from nodegraph.filenames import MAX_BYTES, shorten
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.record_files import read_record

    read_record(arguments.run)  # raises if it is not a run
    folder = arguments.run.resolve()
    stem = shorten(folder.name, MAX_BYTES - len(_SUFFIX))
    path = arguments.out or arguments.run.parent / f"{stem}{_SUFFIX}"
    if path.resolve().is_relative_to(folder):
        raise NodegraphError(f"{path} is in the folder of the run; name another place with --out")
    refuse_unwritable(path)
    contents = contents_of(
        arguments.run, Registry.installed([]), lock=arguments.lock, with_inputs=arguments.inputs
    )
    content = packed(contents.files, crate_metadata(contents))
    # an earlier archive may be published
    if path.exists() and not (path.is_file() and path.read_bytes() == content):
        raise NodegraphError(
            f"{path} already exists and differs; name another file with --out, or remove it first"
        )
    write_and_print(path, content)
    for line in contents.missing:
        say(f"not in it: {line}")
    failed = contents.record.counts.get(State.FAILED, 0)
    if failed:
        say(f"{number_of(failed, 'step')} of this run failed; the archive says so")
    return 0
