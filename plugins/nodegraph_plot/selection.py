"""Selected markers on the face, and how often each was chosen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from nodegraph import Across, Label, Refusal, listed, node
from nodegraph_mocap import Figure, Selection, Table, Trajectories
from nodegraph_plot.recordings import check_something

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nodegraph_plot.selection_figure import Panel


@node("plot.selection")
def selection(
    selections: Across[Selection],
    recordings: Across[Trajectories],
    best: Table | None = None,
    *,
    view: Annotated[str, Field(pattern=r"^(auto|[+-][xyz][+-][xyz])$")] = "auto",
) -> Figure:
    """Draw selected markers on the face, as figure 1 of the marker study: one face per selection.

    Chosen markers are filled, the others hollow; the colour is the share of the method's runs
    that chose the marker's pair, grey where that is not known. The marker set's edges are grey
    lines. Above each face stands how many of the recording's markers are chosen.

    Parameters
    ----------
    selections
        Drawn in their order.
    recordings
        The faces to draw them on, each the mean of its samples: a selection is drawn on the
        recording whose labels are among its own, so that one recording of an actor serves for
        every size of selection.
    best
        Draws only the selections that its rows name, in the order of the rows: the columns that
        are called as the selections' axes hold their labels. Where it has a column ``marked``,
        only the rows that have something there count, as in the table of `compare.curve`.
    view
        ``auto``, or the recording's axes that point right and up in the picture, such as
        ``+x+y``. ``auto`` finds the front of each recording's mean face, as in `plot.faces`.

    Raises
    ------
    Refusal
        If `best` has no rows, or none is marked.
    ValueError
        If there is no selection, `best` names one that is not there or has no column of the
        selections' axes, no recording (or more than one) belongs to a selection, or the
        recording has no frames, no markers, or lacks a selected one.
    """
    from nodegraph_plot.selection_figure import draw

    if not len(selections):
        raise ValueError("there is no selection to draw")
    chosen = list(selections) if best is None else _named(selections, best)
    return draw([_panel(labels, item, recordings) for labels, item in chosen], view)


def _panel(
    labels: Mapping[str, Label], chosen: Selection, recordings: Across[Trajectories]
) -> Panel:
    from nodegraph_plot.selection_figure import Panel

    name = _text(labels)
    matches = [
        recording
        for at, recording in recordings
        if all(labels.get(axis, "") == label for axis, label in at.items() if label != "")
    ]
    if len(matches) != 1:
        there = "; ".join(filter(None, recordings.names())) or "one without labels"
        raise ValueError(
            f"{len(matches) or 'no'} recordings belong to the selection {name or 'without labels'}"
            f", one is needed; there are {len(recordings)}: {there}"
        )
    check_something(f"the recording of {name}" if name else "", matches[0])
    lacking = [marker for marker in chosen.chosen if marker not in matches[0].markers]
    if lacking:
        raise ValueError(
            f"the recording lacks what is selected{f' in {name}' if name else ''}: "
            f"{', '.join(lacking)}"
        )
    return Panel(name, chosen, matches[0])


def _named(
    selections: Across[Selection], best: Table
) -> list[tuple[Mapping[str, Label], Selection]]:
    """Return the selections that the rows name, each once."""
    if "marked" in best.columns:
        best = best[best["marked"] != ""]
    if not len(best):
        raise Refusal("nothing is marked, so there is no selection to draw")
    axes = [axis for axis in selections.axes if axis in best.columns]
    if not axes:
        raise ValueError(
            f"best has no column of an axis of the selections; axes: {listed(selections.axes)}; "
            f"columns: {listed(best.columns)}"
        )
    rows = dict.fromkeys(zip(*(best[axis].tolist() for axis in axes), strict=True))
    return [
        match for row in rows for match in _matching(selections, dict(zip(axes, row, strict=True)))
    ]


def _matching(
    selections: Across[Selection], row: Mapping[str, object]
) -> list[tuple[Mapping[str, Label], Selection]]:
    matches = [
        (labels, selection)
        for labels, selection in selections
        if all(labels.get(axis, "") == label for axis, label in row.items())
    ]
    if not matches:
        raise ValueError(
            f"best names {_text(row)}, but there is no such selection; there are: "
            f"{'; '.join(selections.names())}"
        )
    return matches


def _text(labels: Mapping[str, object]) -> str:
    """Return labels with their axes where these are needed to understand them: ``ME, k 35``."""
    return ", ".join(
        str(label) if isinstance(label, str) else f"{axis} {label}"
        for axis, label in labels.items()
        if label != ""
    )
