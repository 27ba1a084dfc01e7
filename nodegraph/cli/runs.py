"""``nodegraph runs``: list runs with their date, title, options and answer."""

from __future__ import annotations

import shlex
import sys
import textwrap
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

from nodegraph.cli.output import columns
from nodegraph.errors import NodegraphError

HELP = "List runs with their date, title, options and answer."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "folder",
        nargs="?",
        type=Path,
        default=Path("runs"),
        metavar="DIR",
        help="Folder that contains run folders (default: %(default)s).",
    )


def runs(arguments: Namespace) -> int:
    """List the runs in a folder, the latest first."""
    from shutil import get_terminal_size

    folder: Path = arguments.folder
    if not folder.is_dir():
        raise NodegraphError(f"{folder}: no such folder; `nodegraph run GRAPH` writes to runs/")
    rows = sorted(_rows(folder), reverse=True)
    if not rows:
        raise NodegraphError(f"{folder} holds no runs; `nodegraph run GRAPH` writes one to runs/")
    width = get_terminal_size().columns if sys.stdout.isatty() else sys.maxsize
    for ended, name, title, options, answer in rows:
        date = datetime.fromtimestamp(ended).strftime("%Y-%m-%d %H:%M")
        print(columns([(date, name, title, textwrap.shorten(options, 80, placeholder=" ..."))]))
        if answer:
            print(textwrap.indent(textwrap.shorten(answer, width - 4, placeholder=" ..."), "    "))
    return 0


def _rows(folder: Path) -> Iterator[tuple[float, str, str, str, str]]:
    """Yield time, folder, title, options and answer of each run; without a report, its state."""
    from nodegraph.report.study import read_study
    from nodegraph.runs.folder import EVENTS, STUDY, is_written

    for path in (folder, *folder.iterdir()):
        marks = [path / name for name in (STUDY, EVENTS) if (path / name).is_file()]
        if not marks:
            continue
        ended = marks[0].stat().st_mtime
        try:
            study = read_study(path)
        except NodegraphError as error:
            state = "running" if is_written(path / EVENTS) else "interrupted"
            yield ended, str(path), str(error) if marks[0].name == STUDY else state, "", ""
        else:
            failed = "" if study.ok else " (with failures)"
            options = shlex.join(shlex.split(study.command)[3:])  # nodegraph run GRAPH ...
            answer = next(iter(study.short_answer(1)), "")
            yield ended, str(path), f"{study.title}{failed}", options, answer
