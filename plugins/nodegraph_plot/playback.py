"""Recordings and animations played side by side in the report."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from nodegraph import Across, Truth, node
from nodegraph_mocap import Animation, Playback, Trajectories
from nodegraph_mocap.playback import Panel
from nodegraph_mocap.player.fitting import (
    check_meshes,
    frames_apart,
    out_of_reach,
    thinned,
    thinning_notes,
)
from nodegraph_mocap.player.panels import panel_of
from nodegraph_plot.recordings import by_label


@node("plot.playback")
def playback(
    recordings: Across[Trajectories] | None = None,
    animations: Across[Animation] | None = None,
    truth: Truth[Trajectories] | None = None,
    *,
    view: Annotated[str, Field(pattern=r"^(auto|[+-][xyz][+-][xyz])$")] = "auto",
) -> Playback:
    """Play recordings and animated heads side by side in the report, turned and moved together.

    Each recording is a panel of dots, coloured by where a sample came from (measured, filled,
    repaired), joined by its marker set's edges; each animation is a panel with its shaded head.
    One clock, in seconds, drives all: a panel shows the frame that began last, and holds its last
    frame when it is shorter than others. The recordings have one scale, and so have the heads;
    each panel is centred on what was measured of it. The reader plays, slows down, steps, goes from
    gap to gap, drags to turn, enlarges, and shows trails or errors ten times as large; nothing
    moves by itself. It opens at the frame with most samples that a method has made,
    and whose truth is known if there is one, else at the first. Up to six panels are shown at a
    time: of more these are at first the truth and the three of least error, and the reader chooses
    others.

    With a truth, its own panel comes first, a hollow circle shows where each made or missing
    sample should be, and the colours can show the error instead. A missing sample is not drawn
    elsewhere; the panel counts it.

    Together, frames times markers (or times morph targets) may come to 2,000,000: 10 recordings of
    60 markers and 3,333 frames. Of more, every second, third, ... frame is played, which a warning
    and the report say. Beside the report lies the playback as a page of its own.

    Parameters
    ----------
    recordings
        Shown in their order.
    animations
        Shown after the recordings. A frame with a missing weight has no head.
    truth
        Its markers are matched by name.
    view
        ``auto``, or the axes that point right and up in the pictures at first, such as ``+x+y``.
        ``auto`` finds the front of each recording's mean face as `plot.faces` does, and that of a
        head by the vertices that carry its markers.

    Raises
    ------
    Refusal
        If a head has no triangles, or the heads are too large: more than 1,000,000 vertices,
        those of each morph target counted.
    ValueError
        If there is neither a recording nor an animation, two of a kind have the same labels, one
        has no frame, the truth has another number of frames or another rate than a recording, or
        `view` is not of that form.
    """
    shown: list[tuple[str, Trajectories | Animation]] = [
        *(by_label("recording", recordings).items() if recordings else ()),
        *(by_label("animation", animations).items() if animations else ()),
    ]
    if not shown:
        raise ValueError("there is neither a recording nor an animation to play")
    check_meshes(shown)
    known = [("truth", truth)] if truth is not None else []
    every = frames_apart(value for _, value in [*known, *shown])
    panels = [_panel(label, value, every, view) for label, value in [*known, *shown]]
    notes = [*thinning_notes(every), *out_of_reach(panels)]
    for note in notes:
        warnings.warn(note, stacklevel=2)
    return Playback(
        panels=tuple(panels[len(known) :]),
        truth=panels[0] if known else None,
        every=every,
        notes=(*notes, *_absent("recording", recordings), *_absent("animation", animations)),
    )


def _panel(label: str, value: Trajectories | Animation, every: int, view: str) -> Panel:
    if not value.frames:
        raise ValueError(f"{label or 'what is to be played'} has no frame")
    return panel_of(label, thinned(value, every), view)


def _absent(kind: str, gathered: Across[object] | None) -> Iterator[str]:
    for absence in gathered.absent if gathered else ():
        name = ", ".join(str(label) for label in absence.labels.values() if label != "")
        yield f"{kind} {name} is absent: {absence.kind}, {absence.reason}"
