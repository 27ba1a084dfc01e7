"""Gaps of known content on a stream: samples hidden as they arrive."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import StateForm, Truth, Unit, fold, node
from nodegraph_gaps.cut import Cut
from nodegraph_mocap import MarkerFrame, Mask, Origin, Trajectories
from nodegraph_mocap.random_numbers import Seed, entropy
from nodegraph_mocap.truth import truth_of

if TYPE_CHECKING:
    from numpy.typing import NDArray


# numpy compares with an enum's member more slowly
_MEASURED, _REPAIRED = int(Origin.MEASURED), int(Origin.REPAIRED)


class _Stream:
    """The gaps, drawn frame by frame."""

    def __init__(
        self,
        recording: Trajectories,
        truth: Trajectories | None = None,
        *,
        share: float,
        length: int,
        seed: Seed,
    ) -> None:
        markers = recording.markers
        known = truth_of(recording, truth)
        self._order = None if truth is None else [truth.markers.index(name) for name in markers]
        self._chance = _chance(share, length)
        self._length = length
        self._random = np.random.default_rng(entropy(seed))
        self._left = np.zeros(len(markers), dtype=np.intp)
        """Frames for which a marker stays hidden."""
        self._free = np.zeros(len(markers), dtype=np.bool_)
        """Whether the sample before is there."""
        hidden = np.empty((0, len(markers)), dtype=np.bool_)
        self.header = (recording, known, Mask(hidden=hidden, markers=markers))

    def push(
        self, frame: MarkerFrame, truth: MarkerFrame | None = None
    ) -> tuple[MarkerFrame, MarkerFrame, NDArray[np.bool_]]:
        left, origin, positions = self._left, frame.origin, frame.positions.copy()
        left[self._free & (self._random.random(len(left)) < self._chance)] = self._length
        in_gap = left > 0
        hidden = in_gap & ((origin == _MEASURED) | (origin == _REPAIRED))
        if truth is not None:
            hidden &= truth.present[self._order]
        self._free = frame.present & ~in_gap
        left[in_gap] -= 1
        positions[hidden] = np.nan
        gappy = MarkerFrame(
            positions,
            frame.marked(hidden, Origin.MISSING),
            None if frame.sigma is None else np.where(hidden, np.nan, frame.sigma),
        )
        return gappy, frame if truth is None else truth, hidden

    def drain(self) -> Iterable[object]:
        return ()


_FORM = StateForm(_Stream, streams=("recording", "truth"), lookahead=0)


@node("gaps.dropout", live=_FORM)
def dropout(
    recording: Trajectories,
    truth: Truth[Trajectories] | None = None,
    *,
    share: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.05,
    length: Annotated[int, Field(ge=1), Unit("frames")] = 15,
    seed: Seed = 0,
) -> Cut:
    """Hide measured samples at random as they arrive, so that a stream can be filled and scored.

    After a frame in which it is present, each marker is hidden for the next `length` frames with
    probability ``share / (length (1 - share))``: of a marker that is always present, `share` of
    the samples is hidden on average. Only measured (or repaired) samples are hidden, and a
    present one precedes every gap; a gap at the end of the take has no other end. Markers do not
    depend on each other, and nothing depends on later frames, unlike in `gaps.cut`, which draws
    its gaps over a whole take.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps of their own.
    truth
        The recording that errors are measured to, the same frames and markers without noise;
        `recording` itself if left open. A sample that it lacks is not hidden.
    share
        Share of the samples of a marker that is hidden on average.
    length
        Frames that a gap lasts.
    seed
        Same seed, same gaps. A list is another seed for each of its values.

    Raises
    ------
    ValueError
        If gaps of that length with a sample between them cannot hide that share; if the frames,
        rate or markers of `truth` are not those of the recording.
    """
    _chance(share, length)
    truth_of(recording, truth)
    return Cut(*fold(_FORM, recording, truth, share=share, length=length, seed=seed))


def _chance(share: float, length: int) -> float:
    """Return the probability with which a marker that is present is hidden from the next frame."""
    chance = share / (length * (1.0 - share))
    if chance > 1.0:
        raise ValueError(
            f"gaps of {length} frames, with a sample between them, hide at most "
            f"{length / (length + 1):.3g} of the samples; share is {share:g}"
        )
    return chance
