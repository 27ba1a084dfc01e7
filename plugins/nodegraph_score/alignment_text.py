"""The text of an alignment's score: its answer, and what was left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from nodegraph_mocap import Table, Trajectories
    from nodegraph_score.components import Components, Movement

HEAD, FACE = "head motion", "face"
_FEWEST = 2


def answer(parts: Sequence[Table], axes: tuple[str, ...]) -> list[str]:
    """Return what the components are and what head motion makes of them, like with like."""
    alike: dict[str, list[Table]] = {}
    for part in parts:
        alike.setdefault(", ".join(part["finds"]), []).append(part)
    return [_sentence(finds, group, axes) for finds, group in alike.items()]


def _sentence(finds: str, parts: Sequence[Table], axes: tuple[str, ...]) -> str:
    names = ", ".join(filter(None, (named(part, axes) for part in parts)))
    first, every = (
        _percents([part[column].iloc[0] for part in parts]) for column in ("head motion", "in all")
    )
    return (
        f"{names}{': ' if names else ''}PCA finds {finds}, in this order; head motion makes "
        f"{first} of the first component and {every} of all variance."
    )


def named(part: Table, axes: tuple[str, ...]) -> str:
    """Return the labels of a recording's rows as one text."""
    first = part.iloc[0]
    return ", ".join(str(first[axis]) for axis in axes if first[axis] != "")


def _percents(shares: Sequence[float]) -> str:
    # Adding 0 takes the sign from a zero.
    least, most = (round(100 * share) + 0 for share in (min(shares), max(shares)))
    return f"{least}%" if least == most else f"{least} to {most}%"


def left_out(recording: Trajectories, pca: Components, moved: Movement) -> Iterator[str]:
    """Yield what was left out, and what cannot be determined."""
    frames = len(moved.curves)
    if frames < _FEWEST:
        yield f"needs {_FEWEST} complete frames; {_lacking(recording)}"
        return
    if frames < recording.frames:
        yield f"{recording.frames - frames} of {recording.frames} frames lack samples: left out"
    if not len(pca.sd):
        yield "nothing moves: there are no components"
    elif not moved.columns.size:
        yield "the head does not move: nothing can go with it"
    elif not moved.conclusive:
        numbers = moved.basis.shape[1]
        yield f"{frames} frames are too few to say what goes with {numbers} numbers of the head"


def _lacking(recording: Trajectories) -> str:
    complete = int(np.count_nonzero(recording.present.all(axis=1)))
    if not recording.frames or not recording.markers:
        return f"there are {recording.frames} frames of {len(recording.markers)} markers"
    missing = np.count_nonzero(~recording.present, axis=0)
    worst = int(missing.argmax())
    summary = f"{complete} of {recording.frames} are"
    if not missing[worst]:
        return summary
    return f"{summary} ({recording.markers[worst]} alone lacks {missing[worst]}): fill it first"
