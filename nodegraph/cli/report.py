"""``nodegraph report``: write the report of a run again, or a report of several runs."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.output import refuse_existing, write_and_print
from nodegraph.errors import NodegraphError

if TYPE_CHECKING:
    from nodegraph.report.study import Study

HELP = "Write the report of a run again, or a report that shows several runs side by side."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "runs", nargs="+", type=Path, metavar="RUN", help="Folder of a run, such as runs/fill."
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="File to write (default: report.html in the run; required for several runs).",
    )


def report(arguments: Namespace) -> int:
    """Write the report of one run again, or one report of several runs."""
    from nodegraph.report.merge import merged
    from nodegraph.report.page import page
    from nodegraph.report.study import read_study
    from nodegraph.runs.folder import REPORT

    runs = list(dict.fromkeys(arguments.runs))
    studies = {run: read_study(run) for run in runs}
    if arguments.out:
        refuse_existing(arguments.out)
    elif len(runs) > 1:
        raise NodegraphError("name the file for the report of several runs with --out FILE")
    out = arguments.out or runs[0] / REPORT
    named = dict(_linked_from(out.parent, studies))
    study = merged(named) if len(named) > 1 else next(iter(named.values()))
    write_and_print(out, page(study).encode(errors="backslashreplace"))
    return 0


def _linked_from(folder: Path, studies: Mapping[Path, Study]) -> Iterator[tuple[str, Study]]:
    """Yield a name and the study of each run, with links that lead from a folder to the run.

    The name is that of the run's folder, or the path to it where two folders have one name.
    """
    from nodegraph.report.merge import linked

    counts = Counter(run.resolve().name for run in studies)
    for run, study in studies.items():
        path, name = Path(os.path.relpath(run, folder)).as_posix(), run.resolve().name
        yield name if counts[name] == 1 else path, linked(study, path)
