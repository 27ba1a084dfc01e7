"""The state of the folder of a run."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path

from nodegraph.runs.folder import EVENTS, RECORD, STUDY, is_written


class RunState(StrEnum):
    """The state of the folder of a run."""

    RUNNING = "running"
    WRITING = "writing its report"
    INTERRUPTED = "interrupted"
    FINISHED = "finished"
    UNREADABLE = "unreadable"

    @property
    def is_final(self) -> bool:
        """Whether nobody writes to the folder."""
        return self not in (RunState.RUNNING, RunState.WRITING)


def run_state(folder: Path) -> RunState:
    """Return the state of the folder of a run; the files in it are not read.

    Raises
    ------
    OSError
    """
    has_record = (folder / RECORD).is_file()
    if is_written(folder / EVENTS):
        return RunState.WRITING if has_record else RunState.RUNNING
    if has_record:
        return RunState.FINISHED if (folder / STUDY).is_file() else RunState.UNREADABLE
    return RunState.INTERRUPTED if (folder / EVENTS).is_file() else RunState.UNREADABLE
