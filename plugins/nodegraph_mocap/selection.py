"""Selections: which markers were chosen, how often each pair was, and how the search went."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from nodegraph import Value
from nodegraph_mocap.checks import distinct, finite, numbers, set_fields

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Selection(Value):
    """Markers that a method has chosen, and what it saw on the way.

    Attributes
    ----------
    chosen : tuple of str
        The markers, in the order in which `markers.keep` gives them.
    pairs : tuple of tuples of str
        P units that are chosen or left as a whole: a left and a right marker, or one of the
        midline alone. Empty where the method knows none.
    frequencies : (P,) array of float64, or None
        Share of the method's runs that chose each pair, 0 to 1.
    columns : tuple of C str
        Names of the columns of `history`, such as ``k``, ``markers``, ``stability``.
    history : (H, C) array of float64, or None
        A row per trial, such as each k that was tried; NaN where a number is not known.

    Raises
    ------
    ValueError
        If a name is listed twice, a pair holds none, a chosen marker is in no pair though there
        are pairs, shapes disagree, or a frequency is not in 0 to 1.
    """

    chosen: tuple[str, ...]
    pairs: tuple[tuple[str, ...], ...] = ()
    frequencies: NDArray[np.float64] | None = None
    columns: tuple[str, ...] = ()
    history: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        markers = distinct("chosen markers", self.chosen)
        pairs = tuple(tuple(pair) for pair in self.pairs)
        known = distinct("pairs", (name for pair in pairs for name in pair))
        if not all(pairs):
            raise ValueError(f"pairs: number {pairs.index(())} holds no marker")
        apart = [name for name in markers if name not in known] if pairs else []
        if apart:
            raise ValueError(f"chosen, but in no pair: {', '.join(apart)}")
        set_fields(self, chosen=markers, pairs=pairs, columns=distinct("columns", self.columns))
        self._check_numbers()

    def _check_numbers(self) -> None:
        if self.frequencies is not None:
            shares = finite("frequencies", self.frequencies, (len(self.pairs),))
            if shares.size and (shares.min() < 0 or shares.max() > 1):
                raise ValueError(
                    f"frequencies: must be shares, 0 to 1, got {shares.min()} to {shares.max()}"
                )
            set_fields(self, frequencies=shares)
        if self.history is not None:
            rows = numbers("history", self.history, ("rows", len(self.columns)))
            set_fields(self, history=rows)
        elif self.columns:
            raise ValueError(f"columns {', '.join(self.columns)} without a history")
