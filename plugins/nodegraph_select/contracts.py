"""Contracts of every selection of markers, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from nodegraph import Tried
from nodegraph_mocap import Selection, Trajectories, contracts


def takes_a_recording_and_gives_a_selection(tried: Tried) -> Iterator[str]:
    """Take one port that must be fed, `recording`, and give a selection first."""
    selection = next(iter(tried.outputs.values()))
    if not isinstance(tried.inputs.get("recording"), Trajectories):
        yield f"its ports are {', '.join(tried.inputs) or 'none'}; name the recording `recording`"
    elif not isinstance(selection, Selection):
        yield f"its first output is not a selection; it gives {', '.join(tried.outputs)}"


def chooses_markers_of_the_recording(tried: Tried) -> Iterator[str]:
    """Choose at least one marker, and only such as the recording has, in its order."""
    for recording, selection in _before_and_after(tried):
        if not selection.chosen:
            yield "chooses none"
        elif unknown := [name for name in selection.chosen if name not in recording.markers]:
            yield f"chooses {', '.join(unknown)}, which the recording lacks"
        elif list(selection.chosen) != sorted(selection.chosen, key=recording.markers.index):
            chosen = ", ".join(selection.chosen)
            yield f"chooses {chosen}, but the recording has them in another order"


def keeps_pairs_whole(tried: Tried) -> Iterator[str]:
    """Choose both markers of a pair or neither."""
    for recording, selection in _before_and_after(tried):
        pairs = recording.marker_set.pairs if recording.marker_set else ()
        for pair in (*pairs, *selection.pairs):
            inside = [name for name in pair if name in selection.chosen]
            if inside and len(inside) < len(set(pair).intersection(recording.markers)):
                yield f"chooses {', '.join(inside)} of the pair {', '.join(pair)}"


def names_every_marker_once(tried: Tried) -> Iterator[str]:
    """Name each marker of the recording in one pair, if any."""
    for recording, selection in _before_and_after(tried):
        named = [name for pair in selection.pairs for name in pair]
        if named and sorted(named) != sorted(recording.markers):
            odd = ", ".join(sorted(set(named) ^ set(recording.markers)))
            yield f"pairs and markers differ in {odd or 'how often they name one'}"


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Choose the same markers of a recording that has them in another order."""
    for recording, selection in _before_and_after(tried):
        yield from _differences(
            tried, recording.keep(recording.markers[::-1]), selection, "reordered"
        )


def does_not_depend_on_the_origin(tried: Tried) -> Iterator[str]:
    """Choose the same markers of a recording that is shifted as a whole."""
    for recording, selection in _before_and_after(tried):
        shifted = replace(recording, positions=recording.positions + contracts.SHIFT)
        yield from _differences(tried, shifted, selection, "shifted")


def does_not_depend_on_the_size(tried: Tried) -> Iterator[str]:
    """Choose the same markers of a face that is twice as large."""
    for recording, selection in _before_and_after(tried):
        sigma = None if recording.sigma is None else recording.sigma * contracts.SCALE
        larger = replace(recording, positions=recording.positions * contracts.SCALE, sigma=sigma)
        yield from _differences(tried, larger, selection, "enlarged")


def does_not_depend_on_the_axes(tried: Tried) -> Iterator[str]:
    """Choose the same markers of a recording that is turned, or say "depends on the axes"."""
    if contracts.DEPENDS_ON_AXES in " ".join(tried.doc.lower().split()):
        return
    for recording, selection in _before_and_after(tried):
        turned = replace(recording, positions=recording.positions @ contracts.TURN.T)
        yield from _differences(tried, turned, selection, "turned")


CONTRACTS = (
    takes_a_recording_and_gives_a_selection,
    chooses_markers_of_the_recording,
    keeps_pairs_whole,
    names_every_marker_once,
    does_not_depend_on_the_order_of_markers,
    does_not_depend_on_the_origin,
    does_not_depend_on_the_size,
    does_not_depend_on_the_axes,
)


def _before_and_after(tried: Tried) -> Iterator[tuple[Trajectories, Selection]]:
    recording, selection = tried.inputs.get("recording"), next(iter(tried.outputs.values()))
    if isinstance(recording, Trajectories) and isinstance(selection, Selection):
        yield recording, selection


def _differences(
    tried: Tried, recording: Trajectories, selection: Selection, how: str
) -> Iterator[str]:
    outputs = tried.again(recording=recording)
    again = None if outputs is None else next(iter(outputs.values()))
    if not isinstance(again, Selection):
        yield f"declines the {how} recording"
    elif odd := sorted(set(selection.chosen) ^ set(again.chosen)):
        yield f"only one of the recording and the {how} one has {', '.join(odd)}"
