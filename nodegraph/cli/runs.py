"""``nodegraph runs``: list runs with their date, title, options and answer."""

from __future__ import annotations

import sys
import textwrap
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_json
from nodegraph.cli.output import columns
from nodegraph.errors import NodegraphError
from nodegraph.formatting import options_of

if TYPE_CHECKING:
    from nodegraph.cli.answers import ListedRun

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
    add_json(parser)


def runs(arguments: Namespace) -> int:
    """List the runs in a folder, the latest first."""
    from shutil import get_terminal_size

    from nodegraph.cli.answers import RunsAnswer, print_json

    folder: Path = arguments.folder
    if not folder.is_dir():
        raise NodegraphError(f"{folder}: no such folder; `nodegraph run GRAPH` writes to runs/")
    found = sorted(_runs(folder), key=lambda run: (run.ended, run.folder), reverse=True)
    if arguments.json:
        print_json(RunsAnswer(found))
        return 0
    if not found:
        raise NodegraphError(f"{folder} holds no runs; `nodegraph run GRAPH` writes one to runs/")
    width = get_terminal_size().columns if sys.stdout.isatty() else sys.maxsize
    for run in found:
        state = {"done": "", "failed": " (with failures)"}.get(run.state, run.state)
        date = datetime.fromisoformat(run.ended).strftime("%Y-%m-%d %H:%M")
        short = textwrap.shorten(options_of(run.command), 80, placeholder=" ...")
        print(columns([(date, run.folder, f"{run.title}{state}", short)]))
        for answer in run.answer[:1]:
            print(textwrap.indent(textwrap.shorten(answer, width - 4, placeholder=" ..."), "    "))
    return 0


def _runs(folder: Path) -> Iterator[ListedRun]:
    """Yield each run in a folder; without a report, only its state."""
    from nodegraph.cli.answers import ListedRun
    from nodegraph.report.study import read_study
    from nodegraph.runs.folder import EVENTS, STUDY
    from nodegraph.runs.state import RunState, run_state

    for path in (folder, *folder.iterdir()):
        marks = [path / name for name in (STUDY, EVENTS) if (path / name).is_file()]
        if not marks:
            continue
        ended = datetime.fromtimestamp(marks[0].stat().st_mtime).isoformat()
        try:
            study = read_study(path)
        except NodegraphError as error:
            is_unreadable = (now := run_state(path)) in (RunState.FINISHED, RunState.UNREADABLE)
            why = str(error) if is_unreadable else now
            yield ListedRun(str(path), ended, why, "", "", ())
        else:
            state = "done" if study.ok else "failed"
            answer = study.short_answer(1)
            yield ListedRun(str(path), ended, state, study.title, study.command, answer)
