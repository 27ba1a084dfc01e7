"""Faces from the front: which samples were measured and which filled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Across, Truth, node
from nodegraph_mocap import Figure, Trajectories
from nodegraph_plot.recordings import check_frames, check_truth, comparable, named

if TYPE_CHECKING:
    from numpy.typing import NDArray

_COLUMNS = 4


@node("plot.faces")
def faces(
    recordings: Across[Trajectories],
    truth: Truth[Trajectories] | None = None,
    *,
    frames: tuple[int, ...] = (),
    view: Annotated[str, Field(pattern=r"^(auto|[+-][xyz][+-][xyz])$")] = "auto",
) -> Figure:
    """Draw faces from the front, a row per recording, a column per frame.

    Measured samples are blue and filled ones red, as in figure 6 of Zhang, Liang and Wei,
    "Scattered data processing approach based on optical facial motion capture"; repaired samples
    are orange diamonds. With a truth, a hollow circle shows where each filled sample should be,
    joined to the sample by a line, and where a sample that is still missing should be. The marker
    set's edges are grey lines where both ends are present. All faces have one scale; how many
    filled samples lie outside a picture is written in its corner.

    Parameters
    ----------
    recordings
        Drawn in their order.
    truth
        Its markers are matched by name.
    frames
        Default: four evenly spaced ones of the frames in which a recording has made samples,
        with a known truth where there are any,
        else of the frames in which one lacks samples, else of the take.
    view
        ``auto``, or the recording's axes that point right and up in the picture, such as
        ``+x+y``. ``auto`` finds the front of each recording's mean face. With pairs in its marker
        set, the face's left is on the right; forward is where the middle of the face stands out.
        Without pairs, forward is the direction of least extent, and up the recording's y or z
        axis.

    Raises
    ------
    ValueError
        If a recording has no frames, no markers or lacks a frame that is asked for, the truth has
        another number of frames than a recording, or `view` is not of that form.
    """
    from nodegraph_plot.face_figure import draw

    by_name = named(recordings)
    check_truth(by_name, truth)
    chosen = frames or _frames_to_show(list(by_name.values()), truth)
    check_frames(by_name, chosen)
    return draw(by_name, truth, chosen, view)


def _frames_to_show(recordings: list[Trajectories], truth: Trajectories | None) -> tuple[int, ...]:
    length = min(recording.frames for recording in recordings)
    for flags in (
        [comparable(recording, truth) for recording in recordings],
        [~recording.present for recording in recordings],
    ):
        candidates = np.flatnonzero(np.any([flag[:length].any(axis=1) for flag in flags], axis=0))
        if len(candidates):
            return _spaced(candidates)
    return _spaced(np.arange(length))


def _spaced(frames: NDArray[np.intp]) -> tuple[int, ...]:
    places = np.linspace(0, len(frames) - 1, min(_COLUMNS, len(frames))).round().astype(int)
    return tuple(frames[places].tolist())
