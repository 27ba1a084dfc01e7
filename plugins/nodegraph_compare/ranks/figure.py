"""Demsar's critical-difference diagram: mean ranks on a line, bars where methods are not apart."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from nodegraph_compare.inference import LEVEL
from nodegraph_compare.left_out import group_text
from nodegraph_compare.pictures import without_drawing
from nodegraph_compare.ranks.ranking import runs
from nodegraph_mocap import figure_text
from nodegraph_tables.style import BEST, BLACK, REST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from nodegraph_compare.question import Question
    from nodegraph_compare.ranks.ranking import PairTest, Ranking

_WIDTH = 7.6
_ROW = 0.23
"""Inches that a line of text takes."""

_BAR = 0.5
"""Rows that a bar takes."""

_MOST_PANELS = 12
_MOST_METHODS = 60


def draw(question: Question, rankings: Sequence[Ranking], test: PairTest) -> Figure:
    """Return a diagram per group, below each other; what no bar joins to the best is grey.

    Parameters
    ----------
    question, rankings
        Of the comparison.
    test
        Of the pairs.
    """
    panels = [r for r in rankings if len(r.values) and len(r.methods) > 1][:_MOST_PANELS]
    if not panels:
        return without_drawing("nothing to rank")
    packed = [_packed(runs(ranking)) for ranking in panels]
    heights = [_rows(ranking, levels) for ranking, levels in zip(panels, packed, strict=True)]
    figure = Figure(figsize=(_WIDTH, _ROW * sum(heights)), layout="constrained")
    axes = figure.subplots(len(panels), 1, height_ratios=heights, squeeze=False).ravel()
    for axis, ranking, levels, height in zip(axes, panels, packed, heights, strict=True):
        axis.set_ylim(height - 2.8, -2.8)
        axis.axis("off")
        _scale(axis, ranking, test)
        _bars(axis, ranking, levels)
        colours = _colours(ranking)
        _methods(axis, ranking, levels, colours)
        for rank, colour in zip(ranking.ranks, colours, strict=True):
            axis.plot(rank, 0, "o", color=colour, markersize=5, clip_on=False)
        axis.set_title(figure_text(group_text(ranking.group, question)), fontsize=10, loc="left")
    more = len(rankings) - len(panels)
    if more:
        figure.supxlabel(f"{more} more groups are not drawn", fontsize=8)
    return figure


def _colours(ranking: Ranking) -> list[str]:
    """Return the colour of each method: of the first, of those not apart from it, of the rest.

    Where nothing is told apart, nothing is marked.
    """
    if not ranking.differ or ranking.objections(""):
        return [BLACK] * len(ranking.ranks)
    first, pairs = ranking.ranks == ranking.ranks.min(), ranking.pairs
    near = ~(pairs.p < LEVEL) & (first[pairs.first] | first[pairs.second])
    joined = {*pairs.first[near].tolist(), *pairs.second[near].tolist()}
    return [
        BEST if is_first else BLACK if place in joined else REST
        for place, is_first in enumerate(first)
    ]


def _rows(ranking: Ranking, levels: Sequence[Sequence[tuple[int, int]]]) -> float:
    lines = math.ceil(min(len(ranking.methods), _MOST_METHODS) / 2)
    return 4.4 + _BAR * len(levels) + lines


def _packed(bars: list[tuple[int, int]]) -> list[list[tuple[int, int]]]:
    """Return bars in levels, in each of which none touches another."""
    levels: list[list[tuple[int, int]]] = []
    for first, last in bars:
        free = next((level for level in levels if level[-1][1] < first), None)
        if free is None:
            levels.append([(first, last)])
        else:
            free.append((first, last))
    return levels


def _scale(axis: Axes, ranking: Ranking, test: PairTest) -> None:
    """Draw the line of ranks, 1 on the left, and how long the critical difference is."""
    count = len(ranking.methods)
    margin = 0.22 * (count - 1)
    axis.set_xlim(1 - margin, count + margin)
    axis.plot([1, count], [0, 0], color=BLACK, linewidth=1)
    step = math.ceil(count / 20)
    for place in range(1, count + 1):
        axis.plot([place, place], [0, -0.35], color=BLACK, linewidth=0.8)
        if (place - 1) % step == 0:
            axis.text(place, -0.5, str(place), ha="center", va="bottom", fontsize=9)
    critical = ranking.overall.critical
    if test == "nemenyi" and math.isfinite(critical):
        _critical(axis, critical, count)
    else:
        axis.text(1, -1.9, "mean rank", va="bottom", fontsize=9)


def _critical(axis: Axes, critical: float, count: int) -> None:
    end = min(1 + critical, count)
    axis.plot([1, end], [-1.9, -1.9], color=BLACK, linewidth=1.6)
    for place in (1, end)[: 2 if end < count else 1]:
        axis.plot([place, place], [-2.1, -1.7], color=BLACK, linewidth=1.2)
    beyond = "" if end < count else " (longer than the scale)"
    axis.text(
        end + 0.01 * count, -1.9, f"  critical difference {critical:.2f}{beyond}",
        va="center", fontsize=9,
    )  # fmt: skip


def _bars(axis: Axes, ranking: Ranking, levels: Sequence[Sequence[tuple[int, int]]]) -> None:
    ordered = np.sort(ranking.ranks)
    beyond = 0.006 * len(ordered)
    for row, level in enumerate(levels):
        height = 0.7 + _BAR * row
        for first, last in level:
            axis.plot(
                [ordered[first] - beyond, ordered[last] + beyond], [height, height],
                color=BLACK, linewidth=3, solid_capstyle="butt",
            )  # fmt: skip


def _methods(
    axis: Axes,
    ranking: Ranking,
    levels: Sequence[Sequence[tuple[int, int]]],
    colours: Sequence[str],
) -> None:
    """Draw a line from each rank to its method's name: the better half left, the rest right."""
    order = np.argsort(ranking.ranks, kind="stable").tolist()
    shown = order[:_MOST_METHODS]
    half = math.ceil(len(shown) / 2)
    count = len(order)
    top = 1.05 + _BAR * len(levels)
    reach = 0.02 * (count - 1)
    for place, method in enumerate(shown):
        left = place < half
        height = top + (place if left else len(shown) - 1 - place)
        rank, name = float(ranking.ranks[method]), str(ranking.methods[method])
        end = 1 - reach if left else count + reach
        axis.plot([rank, rank, end], [0, height, height], color=colours[method], linewidth=1.0)
        text = f"{figure_text(name)}  {rank:.2f}" if left else f"{rank:.2f}  {figure_text(name)}"
        axis.text(
            end - reach / 2 if left else end + reach / 2, height, text,
            ha="right" if left else "left", va="center", fontsize=9,
            color=BEST if colours[method] == BEST else BLACK,
        )  # fmt: skip
    if len(order) > len(shown):
        axis.text(
            count, -1.9, f"{len(order) - len(shown)} more methods are not named", ha="right",
            fontsize=8,
        )  # fmt: skip
