"""The picture of probabilities: a bar per method, better, equivalent and worse."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from nodegraph_compare.left_out import group_text
from nodegraph_mocap import figure_text
from nodegraph_tables.axes import plain
from nodegraph_tables.style import BEST, BLACK, LINE, REST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.bayes.beliefs import Beliefs
    from nodegraph_compare.question import Margin, Question

_MOST_PANELS = 12


def draw(known: Sequence[Beliefs], question: Question, margin: Margin) -> Figure:
    """Return the figure: a panel per group, at most twelve, and a bar per method.

    The wide bar is the mean over clusters, the narrow one below it a further cluster.

    Parameters
    ----------
    known
        The probabilities of each group.
    question
        What is compared.
    margin
        Within which methods count as equal.
    """
    panels = known[:_MOST_PANELS]
    counts = [len(belief.places) for belief in panels]
    height = 0.34 * sum(counts) + 0.55 * len(panels) + 0.7
    figure = Figure(figsize=(7.0, height), layout="constrained")
    axes = figure.subplots(len(panels), 1, height_ratios=counts, squeeze=False).ravel()
    names = ("better", f"within {margin}", "worse")
    for axis, belief in zip(axes, panels, strict=True):
        rows = np.arange(len(belief.places), dtype=float)
        for offset, size, chances in ((-0.1, 0.5, belief.mean), (0.29, 0.2, belief.new)):
            left = np.zeros(len(rows))
            for name, colour, share in zip(names, (BEST, LINE, REST), chances, strict=True):
                label = figure_text(name) if size == 0.5 else None
                axis.barh(rows + offset, share, size, left=left, color=colour, label=label)
                left += share
        methods = [figure_text(belief.group.methods[place]) for place in belief.places]
        axis.set_yticks(rows, methods)
        axis.invert_yaxis()
        axis.set_xlim(0, 1)
        plain(axis, grid="x")
        axis.tick_params(axis="y", labelcolor=BLACK)
        against = f"against {belief.group.methods[belief.reference]}"
        title = ", ".join(filter(None, [group_text(belief.group, question), against]))
        axis.set_title(figure_text(title), fontsize=10, loc="left")
    axes[-1].set_xlabel("probability; narrow bars: of a further unit")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", frameon=False)
    if len(known) > len(panels):
        figure.supxlabel(f"{len(known) - len(panels)} more groups are not drawn", fontsize=8)
    return figure
