"""The picture of a comparison: means over blocks with their intervals."""

from __future__ import annotations

import math
from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter, NullFormatter

from nodegraph_mocap.style import PALE, looks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.summary import Summary
    from nodegraph_mocap.style import Look

_WIDEST_LINEAR = 30.0
_PANELS_PER_ROW = 3
_SPREAD = 0.76


def draw(
    question: Question, found: Sequence[Summary], order: tuple[Label, ...], unit: str
) -> Figure:
    """Return the figure: the last of `within` along x, a panel per combination of the others.

    Without `within`, the methods stand along x. A method looks the same in every panel. The
    scale is logarithmic where the means span more than a factor of 30.
    """
    if not question.within:
        return _one_group(question, found, order, unit)
    panels: dict[tuple[Label, ...], list[Summary]] = defaultdict(list)
    for one in found:
        panels[one.group.labels[:-1]].append(one)
    places = list(dict.fromkeys(one.group.labels[-1] for one in found))
    figure, axes = _grid(len(panels), len(places) * max(len(order), 2))
    for axis, (labels, summaries) in zip(axes, panels.items(), strict=True):
        _panel(axis, summaries, places, order)
        pairs = zip(question.within[:-1], labels, strict=True)
        axis.set_title(", ".join(f"{name} {label}" for name, label in pairs))
        axis.set_xlabel(question.within[-1])
    _scale(axes, found)
    for axis in axes[::_PANELS_PER_ROW]:
        axis.set_ylabel(_quantity(question, unit))
    _legend(figure, axes, found, order)
    return figure


def _one_group(
    question: Question, found: Sequence[Summary], order: tuple[Label, ...], unit: str
) -> Figure:
    figure, (axis,) = _grid(1, len(order) * 2)
    look = looks(order)
    for one in found:
        for place, label in enumerate(order):
            if label in one.group.methods:
                _point(axis, np.array([place]), [one], label, look[str(label)])
    axis.set_xticks(range(len(order)), [str(label) for label in order])
    if len(order) > 4 or max((len(str(label)) for label in order), default=0) > 12:
        axis.tick_params(axis="x", rotation=40)
        for text in axis.get_xticklabels():
            text.set(ha="right", rotation_mode="anchor")
    axis.set_xlim(-0.6, len(order) - 0.4)
    _scale([axis], found)
    axis.set_xlabel(question.compare or "")
    axis.set_ylabel(_quantity(question, unit))
    return figure


def _grid(panels: int, points: int) -> tuple[Figure, list[Axes]]:
    columns = max(1, min(panels, _PANELS_PER_ROW))
    rows = max(1, math.ceil(panels / columns))
    width = min(max(3.4, 1.2 + 0.17 * points), 11.0 / columns)
    figure = Figure(figsize=(max(columns * width, 4.2), 3.1 * rows + 0.6), layout="constrained")
    axes = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
    for axis in axes[panels:]:
        axis.remove()
    return figure, list(axes[: max(panels, 1)])


def _panel(
    axis: Axes, summaries: Sequence[Summary], places: list[Label], order: tuple[Label, ...]
) -> None:
    look = looks(order)
    offsets = (np.arange(len(order)) - (len(order) - 1) / 2) * _SPREAD / max(len(order), 1)
    for offset, label in zip(offsets, order, strict=True):
        having = [one for one in summaries if label in one.group.methods]
        x = np.array([places.index(one.group.labels[-1]) + offset for one in having])
        _point(axis, x, having, label, look[str(label)])
    for place in range(1, len(places), 2):
        axis.axvspan(place - 0.5, place + 0.5, color=PALE, alpha=0.6, linewidth=0, zorder=0)
    axis.set_xticks(range(len(places)), [str(place) for place in places])
    axis.set_xlim(-0.5, len(places) - 0.5)


def _point(
    axis: Axes, x: NDArray[np.float64], having: Sequence[Summary], label: Label, look: Look
) -> None:
    """Draw the means of one method; no bar where there is no interval."""
    columns = [one.group.methods.index(label) for one in having]
    mean, low, high = (
        np.array([getattr(one, name)[column] for one, column in zip(having, columns, strict=True)])
        for name in ("mean", "low", "high")
    )
    axis.errorbar(
        x,
        mean,
        yerr=np.nan_to_num(np.clip([mean - low, high - mean], 0, None)),
        color=look.colour,
        marker=look.marker,
        markersize=5,
        linestyle="none",
        elinewidth=1.3,
        capsize=2,
        label=str(label),
    )


def _scale(axes: Sequence[Axes], found: Sequence[Summary]) -> None:
    means = np.concatenate([one.mean for one in found]) if found else np.empty(0)
    means = means[np.isfinite(means)]
    wide = len(means) and means.min() > 0 and means.max() > _WIDEST_LINEAR * means.min()
    for axis in axes:
        if wide:
            axis.set_yscale("log")
            axis.yaxis.set_major_formatter(LogFormatter(labelOnlyBase=False))
            axis.yaxis.set_minor_formatter(NullFormatter())
        elif len(means) and means.min() >= 0:
            axis.set_ylim(bottom=0)
        axis.grid(axis="y", color="0.85", linewidth=0.6)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)


def _legend(
    figure: Figure, axes: Sequence[Axes], found: Sequence[Summary], order: tuple[Label, ...]
) -> None:
    handles, _ = axes[0].get_legend_handles_labels()
    known = {
        label
        for one in found
        for label, blocks in zip(one.group.methods, one.blocks, strict=True)
        if blocks
    }
    names = [str(label) + ("" if label in known else " (no value)") for label in order]
    if len(order) > 1:
        figure.legend(handles, names, loc="outside right upper", frameon=False)


def _quantity(question: Question, unit: str) -> str:
    return f"mean {question.metric}" + (f" ({unit})" if unit else "")
