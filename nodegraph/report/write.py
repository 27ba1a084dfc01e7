"""A finished run -> the files of its folder: the record first, each file whole or not at all."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace

from nodegraph.execute.results import Run
from nodegraph.plugin.loading import error_text
from nodegraph.report.from_run import Composed, compose
from nodegraph.report.page import page
from nodegraph.report.study import Study, study_bytes
from nodegraph.runs.folder import RECORD, REPORT, STEPS, STUDY, RunFolder
from nodegraph.runs.record import NotWritten, record
from nodegraph.runs.record_files import record_bytes, steps_bytes


@dataclass(frozen=True)
class WrittenRun:
    """A run in its folder.

    Attributes
    ----------
    study : Study
        The content of the report.
    lost : dict of str to str
        The files that could not be written, and why.
    """

    study: Study
    lost: dict[str, str]


def write_run(run: Run, folder: RunFolder) -> WrittenRun:
    """Write the record of a run, then its tables and figures, then its report.

    A file that cannot be composed or written costs no other one. The record is then written again,
    and lists it.

    Parameters
    ----------
    run
    folder
        Has the graph and the events already.
    """
    return _Writer(folder).write(run)


class _Writer:
    def __init__(self, folder: RunFolder) -> None:
        self._folder = folder
        self._lost: dict[str, NotWritten] = {}

    def write(self, run: Run) -> WrittenRun:
        what_ran = record(run)
        self._write(STEPS, lambda: steps_bytes(what_ran.steps))
        self._write(RECORD, lambda: record_bytes(what_ran))
        composed = self._compose(run)
        lost = [file for name, file in self._lost.items() if name != RECORD]
        if lost or composed.not_shown:
            has_record = RECORD not in self._lost
            complete = replace(what_ran, not_shown=list(composed.not_shown), not_written=lost)
            self._write(RECORD, lambda: record_bytes(complete))
            if has_record and RECORD in self._lost:
                again = self._lost[RECORD]
                reason = f"{again.reason}; the existing one does not list what is lost"
                self._lost[RECORD] = replace(again, reason=reason)
        return WrittenRun(composed.study, {name: file.reason for name, file in self._lost.items()})

    def _compose(self, run: Run) -> Composed:
        try:
            composed = compose(run, write=self._write_beside)
        except Exception as error:
            self._lose(REPORT, error)
            return Composed(Study(run.plan.graph.title), ())
        study = composed.study
        self._write(STUDY, lambda: study_bytes(study))
        # an error may name a file whose name is not valid text
        self._write(REPORT, lambda: page(study).encode(errors="backslashreplace"))
        return composed

    def _write_beside(self, name: str, content: bytes) -> str:
        self._write(name, lambda: content)
        return self._lost[name].reason if name in self._lost else ""

    def _write(self, name: str, content: Callable[[], bytes]) -> None:
        try:
            self._folder.write(name, content())
        except Exception as error:
            self._lose(name, error)
        else:
            self._lost.pop(name, None)

    def _lose(self, name: str, error: Exception) -> None:
        if isinstance(error, OSError):
            self._lost[name] = NotWritten(name, error.strerror or str(error))
        else:
            trace = "".join(traceback.format_exception(error))
            self._lost[name] = NotWritten(name, error_text(error, "nodegraph"), trace)
