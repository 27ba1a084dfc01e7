"""``nodegraph report``."""

from __future__ import annotations

import os
from argparse import Namespace
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.common import written_and_told
from nodegraph.errors import NodegraphError

if TYPE_CHECKING:
    from nodegraph.report import Study


def report(arguments: Namespace) -> int:
    """Make the report of a finished run again, or one that lays several side by side."""
    from nodegraph.report import page
    from nodegraph.report.files import read_study
    from nodegraph.report.study import merged

    runs = list(dict.fromkeys(arguments.runs))
    studies = {run: read_study(run) for run in runs}
    out = arguments.out or (runs[0] / "report.html" if len(runs) == 1 else None)
    if out is None:
        raise NodegraphError("say by --out FILE where the report of several runs is to be written")
    if arguments.out and out.exists():
        raise NodegraphError(f"{out} is there already; name another file, or remove it first")
    named = dict(_seen_from(out.parent, studies))
    study = merged(named) if len(named) > 1 else next(iter(named.values()))
    written_and_told(out, page(study).encode(errors="backslashreplace"))
    return 0


def _seen_from(folder: Path, studies: Mapping[Path, Study]) -> Iterator[tuple[str, Study]]:
    """Yield each study, its links leading to its run, with the name that readers know it by.

    That is the run's folder, or the way to it where two are called alike.
    """
    from nodegraph.report.study import linked

    called = Counter(run.resolve().name for run in studies)
    for run, study in studies.items():
        where, name = Path(os.path.relpath(run, folder)).as_posix(), run.resolve().name
        yield name if called[name] == 1 else where, linked(study, where)
