"""A finished run -> the files of its report, and what a terminal shows of it."""

from __future__ import annotations

import gzip
import json
import zlib
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.report.compose import compose
from nodegraph.report.page import page
from nodegraph.report.study import Study
from nodegraph.runs.settings import RunSettings
from nodegraph.state import State
from nodegraph.validation import first_error

if TYPE_CHECKING:
    from pydantic import TypeAdapter


STUDY = "study.json.gz"


def study_bytes(study: Study) -> bytes:
    """Return a study as compressed JSON, without the files that lie beside the report anyway."""
    sections = tuple(
        replace(one, rendered=replace(one.rendered, files={})) for one in study.sections
    )
    # what failed may name a file whose name is no text: only JSON's own escapes can carry that
    content = json.dumps(_adapter().dump_python(replace(study, sections=sections)))
    return gzip.compress(content.encode(), compresslevel=6, mtime=0)


def read_study(folder: Path) -> Study:
    """Return the study of a run that lies in a folder.

    Raises
    ------
    NodegraphError
        If there is none, or none that this version can read.
    """
    from pydantic import ValidationError

    path = folder / STUDY
    try:
        data = json.loads(gzip.decompress(path.read_bytes()))
        return _adapter().validate_python(data)
    except (FileNotFoundError, NotADirectoryError):
        raise NodegraphError(
            f"{path}: there is no finished run; run the graph, or name the folder of a run"
        ) from None
    except ValidationError as error:
        reason = first_error(error, data)
        raise NodegraphError(f"{path} cannot be read ({reason}); run the graph again") from error
    except (OSError, EOFError, zlib.error, ValueError, RecursionError) as error:
        raise NodegraphError(f"{path} cannot be read ({error}); run the graph again") from error


@cache
def _adapter() -> TypeAdapter[Study]:
    from pydantic import TypeAdapter

    return TypeAdapter(Study)


_MOST_FAILURES = 5
_WORDS: dict[str, str] = {State.DONE: "computed", State.UNNEEDED: "not needed"}


def report_files(run: Run, settings: RunSettings) -> tuple[dict[str, bytes], Study]:
    """Return the report, the tables and the figures of a run by file name, and its study."""
    study, files = compose(run, settings)
    # what failed may name a file whose name is no text
    text = page(study).encode(errors="backslashreplace")
    return {**files, STUDY: study_bytes(study), "report.html": text}, study


def summary(study: Study, run: Run) -> str:
    """Return what a terminal shows of a run: its tables, its answer, how its steps ended."""
    parts = [
        f"{f'{one.title} {one.labels}'.strip()}\n{one.rendered.text}"
        for one in study.sections
        if one.rendered.text
    ]
    parts += ["\n".join(study.answer)] if study.answer else []
    counts = [
        f"{count} {_WORDS.get(state, state)}" for state, count in run.counts().items() if count
    ]
    parts += [f"{len(run.plan.steps)} steps: {', '.join(counts)}"]
    parts += [*_failures(study), *run.not_stored()]
    return "\n\n".join(parts)


def _failures(study: Study) -> Iterator[str]:
    """Yield what failed first, with the command that repeats it alone."""
    failed = [note for note in study.notes if note.kind == "failed"]
    for note in failed[:_MOST_FAILURES]:
        where = f"{note.node} at {note.labels}" if note.labels else note.node
        repeat = f"\n    repeat it alone: {note.repeat}" if note.repeat else ""
        yield f"failed: {where}: {note.reason}{repeat}"
    if len(failed) > _MOST_FAILURES:
        yield f"{len(failed) - _MOST_FAILURES} more failed; the report says which and why"
