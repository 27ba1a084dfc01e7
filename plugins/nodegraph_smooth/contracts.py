"""Contracts of every smoothing, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Origin, Trajectories, contracts

_LAG = 0.05
"""Frames: a shift that is smaller is taken for rounding."""


def adds_no_gap_and_fills_none(tried: Tried) -> Iterator[str]:
    """Leave missing samples missing, present ones present, and every sample's origin."""
    for before, after in contracts.before_and_after(tried):
        lost, filled = before.present & ~after.present, ~before.present & after.present
        renamed = before.present & after.present & (before.origin != after.origin)
        if lost.any():
            samples = contracts.places(before, lost)
            yield f"{samples} lost: smooth each run of present samples by itself"
        if filled.any():
            yield f"{contracts.places(before, filled)} filled: leave that to a fill"
        if renamed.any():
            yield (
                f"{contracts.places(before, renamed)} called otherwise: return "
                "dataclasses.replace(recording, positions=smoothed)"
            )


def shifts_nothing_in_time(tried: Tried) -> Iterator[str]:
    """Shift nothing in time, unless it looks at no frame ahead: then it cannot but lag."""
    for before, _ in contracts.before_and_after(tried):
        nod = _nod(before)
        after = contracts.output_again(tried, nod)
        lag = 0.0 if after is None else _lag(nod, after)
        if after is not None and abs(lag) > _LAG and not _is_causal(tried, nod, after):
            yield (
                f"a nod comes out {abs(lag):.2f} frames {'late' if lag > 0 else 'early'}, "
                "although frames ahead are looked at: centre the window, or filter forward and "
                "backward"
            )


def sigma_belongs_to_its_sample(tried: Tried) -> Iterator[str]:
    """Keep no sigma of samples that are changed: it was that of what they were before."""
    for before, after in contracts.before_and_after(tried):
        if before.sigma is None or after.sigma is None:
            continue
        kept = np.any(before.positions != after.positions, axis=2) & (before.sigma == after.sigma)
        if kept.any():
            yield f"{contracts.places(before, kept)} changed but with its old sigma: make it NaN"


CONTRACTS = (
    contracts.takes_and_gives_a_recording,
    adds_no_gap_and_fills_none,
    contracts.gives_millimetres,
    contracts.looks_ahead_as_declared,
    contracts.moves_with_the_face,
    contracts.turns_with_the_face,
    contracts.scales_with_the_face,
    contracts.runs_with_the_clock,
    contracts.does_not_depend_on_the_order_of_markers,
    shifts_nothing_in_time,
    sigma_belongs_to_its_sample,
)


def _nod(before: Trajectories) -> Trajectories:
    """Return all markers at rest for two seconds, but for one movement of a second amid them."""
    half = max(round(before.rate), 20)
    time = np.arange(-half, half + 1) / half
    way = 20.0 * np.exp(-0.5 * (time / 0.2) ** 2)
    rest = np.arange(3.0 * len(before.markers)).reshape(-1, 3)
    return replace(
        before,
        positions=rest + way[:, None, None] * [0.0, 0.6, 0.8],
        origin=np.full((len(time), len(before.markers)), Origin.MEASURED, dtype=np.uint8),
        sigma=None,
    )


def _lag(nod: Trajectories, after: Trajectories) -> float:
    """Return by how many frames the movement comes later, of its centre of gravity."""
    way = (after.positions - nod.positions[0]) @ [0.0, 0.6, 0.8]
    total = way.sum()
    if abs(total) < 1.0:  # smoothed away: it has no place
        return 0.0
    return float((way.sum(axis=1) @ np.arange(len(way))) / total - (len(way) - 1) / 2.0)


def _is_causal(tried: Tried, nod: Trajectories, after: Trajectories) -> bool:
    """Return whether the first frames come out the same without those after them."""
    count = len(nod.positions) // 2
    again = contracts.output_again(tried, nod[:count])
    if again is None or again.frames != count:
        return False
    return bool(
        np.allclose(again.positions, after.positions[:count], rtol=0.0, atol=contracts.TOLERANCE)
    )
