"""``nodegraph archive``."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from nodegraph.cli.common import refuse_unwritable, say, written
from nodegraph.errors import NodegraphError
from nodegraph.formatting import size_text


def archive(arguments: Namespace) -> int:
    """Put a finished run into one file, with what it takes to run it again elsewhere."""
    from nodegraph.archive.contents import contents_of, packed
    from nodegraph.archive.rocrate import crate_metadata
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.saved_run import FinishedRun

    FinishedRun(arguments.run)  # which refuses what is no run
    folder = arguments.run.resolve()
    path = arguments.out or arguments.run.parent / f"{folder.name}.zip"
    _refuse_inside(path, folder)
    refuse_unwritable(path)
    contents = contents_of(
        arguments.run, Registry.installed([]), lock=arguments.lock, with_inputs=arguments.inputs
    )
    content = packed(contents.files, crate_metadata(contents))
    _refuse_others(path, content)
    written(path, content)
    print(f"{path} ({len(contents.files) + 1} files, {size_text(len(content))})")
    for line in contents.lacking:
        say(f"not in it: {line}")
    failed = contents.record["counts"].get("failed", 0)
    if failed:
        say(f"{failed} steps of this run failed: the archive says so")
    return 0


def _refuse_inside(path: Path, run: Path) -> None:
    if path.resolve().is_relative_to(run):
        raise NodegraphError(f"{path} lies in the run itself; name another place with --out")


def _refuse_others(path: Path, content: bytes) -> None:
    """Refuse to replace anything but the same archive: what was made before may be published."""
    if path.exists() and not (path.is_file() and path.read_bytes() == content):
        raise NodegraphError(
            f"{path} is there already and is another; name another file with --out, or remove it "
            "first"
        )
