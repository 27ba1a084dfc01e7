"""What goes to another process and what comes back: short texts, and buffers as they lie."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from nodegraph.execute.call import Outcome
from nodegraph.execute.elsewhere.frames import Frame

OUTCOME = "outcome"
LACKING = "lacking"
NOT_SENT = "not sent"
INTERRUPTED = "interrupted"


@dataclass(frozen=True)
class Question:
    """A call to be made in another process.

    Attributes
    ----------
    surroundings, address : bytes
        As `Surroundings` and `Address` make them.
    head : bytes
        Inputs and settings, packed.
    buffers : sequence of buffer
    """

    surroundings: bytes
    address: bytes
    head: bytes
    buffers: Sequence[Frame] = ()

    def frames(self) -> list[Frame]:
        """Return it as a list of bytes, buffers last."""
        return [self.surroundings, self.address, self.head, *self.buffers]

    @classmethod
    def from_frames(cls, frames: Sequence[Frame]) -> Question:
        """Return what `frames` made a list of."""
        return cls(bytes(frames[0]), bytes(frames[1]), bytes(frames[2]), frames[3:])


@dataclass(frozen=True)
class Answer:
    """What another process made of a question.

    Attributes
    ----------
    kind : str
        ``outcome``; ``lacking`` when the process lacks the node; ``not sent`` when a value does
        not travel; ``interrupted`` when the node asked for the end of the run.
    outcome : Outcome
        Without values; its reason says why there is none.
    differs : str
        Versions that the process has, where they are not those of the one that asked.
    head : bytes
        The values, packed.
    buffers : sequence of buffer
    """

    kind: str
    outcome: Outcome
    differs: str = ""
    head: bytes = b"null"
    buffers: Sequence[Frame] = ()

    def frames(self) -> list[Frame]:
        """Return it as a list of bytes, buffers last."""
        said = json.dumps([self.kind, asdict(self.outcome), self.differs]).encode()
        return [said, self.head, *self.buffers]

    @classmethod
    def from_frames(cls, frames: Sequence[Frame]) -> Answer:
        """Return what `frames` made a list of."""
        kind, fields, differs = json.loads(bytes(frames[0]))
        fields |= {"values": (), "warnings": tuple(fields["warnings"]), "digests": ()}
        return cls(kind, Outcome(**fields), differs, bytes(frames[1]), frames[2:])
