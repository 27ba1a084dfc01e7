"""What a lock holds of one result, as a line of text and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nodegraph.paper.frozen.projection import as_text, from_text
from nodegraph.paper.frozen.results import Cell, Results

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_WITHOUT = "-"
_EXACT = 8
_ENDED = ("refused", "failed", "skipped")


@dataclass(frozen=True)
class Recorded:
    """What a lock holds of one result.

    Attributes
    ----------
    ended : str
        How it ended where it has no value.
    digest, exact, opaque : str
        Of the values without drawings and files, of what must be equal in them, and of drawings
        and files; empty where there is none.
    projections : array or None
        See `nodegraph.paper.frozen.projection`; None without floats.
    """

    ended: str = ""
    digest: str = ""
    exact: str = ""
    projections: NDArray[np.float64] | None = None
    opaque: str = ""

    @property
    def text(self) -> str:
        """The result in one line."""
        sums = "" if self.projections is None else as_text(self.projections)
        words = [one or _WITHOUT for one in (self.digest, self.exact, sums, self.opaque)]
        while words and words[-1] == _WITHOUT:
            words.pop()
        return self.ended or " ".join(words) or _WITHOUT

    @classmethod
    def read(cls, text: str) -> Recorded:
        """Return what a line says.

        Raises
        ------
        ValueError
            If it says nothing.
        """
        if text.partition(":")[0] in _ENDED:
            return cls(ended=text)
        words = ["" if one == _WITHOUT else one for one in text.split(" ")]
        digest, exact, sums, opaque = [*words, "", "", ""][:4]
        return cls("", digest, exact, from_text(sums) if sums else None, opaque)


def recorded(cell: Cell, results: Results, scale: Mapping[str, float]) -> Recorded:
    """Return what a lock holds of one combination.

    Parameters
    ----------
    cell
    results
    scale
        Usual size of the floats at each place of its values.
    """
    ended = results.ended(cell.index)
    if ended:
        return Recorded(ended)
    found = results.sketch(cell.index)
    return Recorded(
        digest=results.digest(cell.index),
        exact=exact_of(results, cell.index),
        projections=found.against(scale).projections if found and found.leaves else None,
        opaque=results.opaque_digest(cell.index),
    )


def exact_of(results: Results, index: int) -> str:
    """Return a short digest of what must be equal in a step's values."""
    found = results.sketch(index)
    return found.exact[:_EXACT] if found else ""
