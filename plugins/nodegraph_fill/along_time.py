"""The fills along time: each gap is bridged from its ends, or follows markers that have none.

Most take a marker's own samples alone. Nothing is extrapolated: a gap at the start or the end of
the take stays missing, unless a fill needs one end only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import node
from nodegraph_fill.family import LEFT, make_fill
from nodegraph_fill.filling import Filling
from nodegraph_fill.gaps import Gaps, to_gap_end
from nodegraph_fill.kept import kept_of, key_of
from nodegraph_fill.streams import live_form
from nodegraph_fill.tuning import unless_tuned
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Curve = Callable[[NDArray[np.intp], NDArray[np.float64]], Callable[..., NDArray[np.float64]]]
    """Takes frames, (n,), and positions there, (n, 3); returns what gives positions at frames."""

_TWO_ENDS = """\
A gap at the start or at the end of the take has one end only and stays missing, counted in
a warning, as does a marker that is never measured. Samples that are present come out as
they went in; those that an earlier fill has made count like measured ones."""


@dataclass(frozen=True)
class Bridging(Filling):
    """A recording with gaps, and the settings of a fill along time.

    Attributes
    ----------
    ends
        No effect: the fill meets both ends of a gap by itself.
    """


def along_time(
    name: str,
    *,
    cite: str = "none",
    adapted: str = "",
    whole_take: bool = False,
    one_end: bool = False,
    otherwise: str = "",
) -> Callable[[Callable[..., NDArray[np.float64]]], Callable[..., Trajectories]]:
    """Make a method that bridges gaps, and so meets their ends, a fill.

    The method takes positions (T, M, 3) mm, NaN where missing, gaps, and its settings, which are
    keyword-only. It returns the positions of the gaps' samples, (S, 3), in the order of
    `Gaps.samples`; NaN where it has none.

    Parameters
    ----------
    name, cite, adapted
        As for `nodegraph.node`.
    whole_take
        Whether it looks beyond the two samples beside a gap; if not, it runs on a stream.
    one_end
        Whether it fills a gap that the take begins or ends with.
    otherwise
        Why it may leave a sample missing.
    """

    def decorate(method: Callable[..., NDArray[np.float64]]) -> Callable[..., Trajectories]:
        def fill(filling: Bridging, gaps: Gaps, **settings: Any) -> Trajectories:
            recording = filling.recording
            if not len(gaps.start):
                return recording
            kept, key = kept_of(recording), key_of(method, filling, settings)
            if key not in kept:
                kept[key] = method(recording.positions, gaps, **settings)
            positions = recording.positions.copy()
            _, frame, marker, _ = gaps.samples
            positions[frame, marker] = kept[key]
            return recording.with_samples(positions, changed=gaps.mask, origin=Origin.FILLED)

        left = LEFT if one_end else _TWO_ENDS
        return node(
            name,
            cite=cite,
            adapted=adapted,
            lookahead=None if whole_take else unless_tuned(to_gap_end),
            ends=True,
            live=None if whole_take else live_form(partial(partial, method), one_end=one_end),
            shares=Bridging,
        )(make_fill(method, Bridging, fill, left, both_ends=not one_end, otherwise=otherwise))

    return decorate


def on_curves(positions: NDArray[np.float64], gaps: Gaps, curve: Curve) -> NDArray[np.float64]:
    """Return the positions of the gaps' samples on a curve through each marker's own samples.

    Parameters
    ----------
    positions
        (T, M, 3) mm; NaN where missing.
    gaps
        Each between two samples of its marker.
    curve
        Makes the curve of one marker from all its present samples.

    Returns
    -------
    (S, 3) array of float64
        Millimetres, in the order of `Gaps.samples`.
    """
    _, frame, marker, _ = gaps.samples
    values = np.empty((len(frame), 3))
    ends = np.flatnonzero(np.diff(marker)) + 1
    for samples in np.split(np.arange(len(frame)), ends):
        column = marker[samples[0]]
        known = np.flatnonzero(~np.isnan(positions[:, column, 0]))
        values[samples] = curve(known, positions[known, column])(frame[samples])
    return values
