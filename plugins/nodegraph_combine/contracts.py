"""What every node that combines recordings promises, whoever wrote it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from nodegraph import Across, Tried
from nodegraph_mocap import Trajectories

_SHIFT = np.array([110.0, -70.0, 240.0])
_TOLERANCE = 1e-6


def takes_recordings_and_gives_one(tried: Tried) -> Iterator[str]:
    """Take one gathering port, `recordings`, and give a recording of the same markers first."""
    given, made = tried.inputs.get("recordings"), next(iter(tried.outputs.values()))
    if not isinstance(given, Across):
        yield f"its ports are {', '.join(tried.inputs) or 'none'}; name the port `recordings`"
    elif not isinstance(made, Trajectories):
        yield f"its first output is not a recording; it gives {', '.join(tried.outputs)}"
    else:
        first = given.values()[0]
        for what in ("markers", "rate", "frames", "marker_set"):
            if getattr(first, what) != getattr(made, what):
                yield f"{what} went in as {getattr(first, what)}, came out as {getattr(made, what)}"


def keeps_what_all_have_alike(tried: Tried) -> Iterator[str]:
    """Leave samples that all recordings have alike bit for bit as they are."""
    if any(takes_recordings_and_gives_one(tried)):
        return
    given, made = tried.inputs["recordings"].values(), next(iter(tried.outputs.values()))
    alike = np.all([one.positions == given[0].positions for one in given], axis=(0, 3))
    changed = alike & np.any(made.positions != given[0].positions, axis=2)
    if changed.any():
        yield f"{np.count_nonzero(changed)} samples that all have alike are changed"


def does_not_depend_on_the_order(tried: Tried) -> Iterator[str]:
    """Give the same recording when the recordings come in another order."""
    if any(takes_recordings_and_gives_one(tried)):
        return
    pair = _unlike(tried)
    straight, back = (_combined(tried, one) for one in (pair, pair[::-1]))
    if straight is None or back is None:
        yield "declines recordings of two methods"
    elif not _near(straight, back):
        yield "the recordings in another order give another result"


def moves_with_the_face(tried: Tried) -> Iterator[str]:
    """Combine recordings that are shifted as a whole like those that are not."""
    if any(takes_recordings_and_gives_one(tried)):
        return
    pair = _unlike(tried)
    shifted = [replace(one, positions=one.positions + _SHIFT) for one in pair]
    straight, moved = (_combined(tried, one) for one in (pair, shifted))
    if straight is None or moved is None:
        yield "declines recordings that are shifted, or of two methods"
    elif not _near(straight, replace(moved, positions=moved.positions - _SHIFT)):
        yield "shifted recordings give another result"


CONTRACTS = (
    takes_recordings_and_gives_one,
    keeps_what_all_have_alike,
    does_not_depend_on_the_order,
    moves_with_the_face,
)


def _unlike(tried: Tried) -> tuple[Trajectories, Trajectories]:
    """Return a recording, and one in which every seventh present sample is elsewhere."""
    one: Trajectories = tried.inputs["recordings"].values()[0]
    which = np.arange(one.origin.size).reshape(one.origin.shape) % 7 == 3
    return one, replace(one, positions=one.positions + np.where(which, 2.5, 0.0)[..., None])


def _combined(tried: Tried, recordings: Sequence[Trajectories]) -> Trajectories | None:
    made = tried.again(recordings=Across.of(dict(zip("ab", recordings, strict=True)), axis="x"))
    return None if made is None else next(iter(made.values()))


def _near(one: Trajectories, two: Trajectories) -> bool:
    close = np.allclose(one.positions, two.positions, rtol=0, atol=_TOLERANCE, equal_nan=True)
    return close and bool(np.all(one.origin == two.origin))
