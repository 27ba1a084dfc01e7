"""One result as a line of text: digests, and a few numbers for what may differ by rounding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nodegraph.lock.sketch import as_text, from_text
from nodegraph.state import State

_NOTHING = "-"
_WITHOUT_VALUE = (State.REFUSED, State.FAILED, State.SKIPPED)


@dataclass(frozen=True)
class LockedResult:
    """One result as a lock holds it.

    Attributes
    ----------
    ending : str
        State and reason of a step without a value.
    digest, exact, opaque : str
        Of the values without drawings and files, of what must be equal in them, and of drawings
        and files; empty where there is none.
    projections : array or None
        See `nodegraph.lock.sketch`; None without floats.
    """

    ending: str = ""
    digest: str = ""
    exact: str = ""
    projections: NDArray[np.float64] | None = None
    opaque: str = ""

    @property
    def text(self) -> str:
        """The result in one line."""
        projections = "" if self.projections is None else as_text(self.projections)
        words = [word or _NOTHING for word in (self.digest, self.exact, projections, self.opaque)]
        while words and words[-1] == _NOTHING:
            words.pop()
        return self.ending or " ".join(words) or _NOTHING

    @classmethod
    def read(cls, text: str) -> LockedResult:
        """Return the result of a line.

        Raises
        ------
        ValueError
            If the line has another form.
        """
        if text.partition(":")[0] in _WITHOUT_VALUE:
            return cls(ending=text)
        words = ["" if word == _NOTHING else word for word in text.split(" ")]
        digest, exact, projections, opaque = [*words, "", "", ""][:4]
        return cls("", digest, exact, from_text(projections) if projections else None, opaque)
