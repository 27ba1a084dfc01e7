"""The states in which a step of a run can end."""

from __future__ import annotations

from enum import StrEnum


class State(StrEnum):
    """The end of a step.

    A step whose result was found in the store is ``done``; events and counts list it as
    ``stored``. A step is ``unneeded`` if everything that reads it is stored.
    """

    DONE = "done"
    STORED = "stored"
    REFUSED = "refused"
    FAILED = "failed"
    SKIPPED = "skipped"
    UNNEEDED = "unneeded"

    @property
    def has_value(self) -> bool:
        """Whether a step in this state has a value, which may have to be computed first."""
        return self in (State.DONE, State.STORED, State.UNNEEDED)
