"""The picture of what explains a metric: shares of its variance as bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from nodegraph_compare.pictures import without_drawing
from nodegraph_mocap import figure_text
from nodegraph_tables.axes import plain
from nodegraph_tables.style import BEST, BLACK, LINE, REST

if TYPE_CHECKING:
    from nodegraph_compare.question import Question
    from nodegraph_mocap import Table

_MOST = 20


def draw(table: Table, question: Question) -> Figure:
    """Return the figure: a bar per source, the largest on top, at most 20."""
    ordered = table.dropna(subset="eta squared")
    ordered = ordered.sort_values("eta squared", ascending=False, kind="stable").head(_MOST)
    if not len(ordered):
        return without_drawing("nothing to explain")
    places = range(len(ordered))
    factors = ordered["labels"].notna()
    pairs = ordered["source"].str.contains(" x ", regex=False)
    colours = [
        BEST if factor else REST if pair else LINE
        for factor, pair in zip(factors, pairs, strict=True)
    ]
    figure = Figure(figsize=(6.0, 0.9 + 0.3 * len(ordered)), layout="constrained")
    axis = figure.subplots()
    axis.barh(places, ordered["eta squared"], color=colours, height=0.7)
    for place, share in zip(places, ordered["eta squared"], strict=True):
        axis.annotate(
            f"{share:.1%}", (share, place), xytext=(3, 0), textcoords="offset points",
            va="center", fontsize=9,
        )  # fmt: skip
    axis.set_yticks(places, [figure_text(source) for source in ordered["source"]])
    axis.invert_yaxis()
    axis.set_xlim(0, min(1.0, 1.15 * ordered["eta squared"].max()) + 0.05)
    axis.xaxis.set_major_formatter(lambda share, _: f"{share:.0%}")
    axis.set_xlabel(figure_text(f"share of the variance of {question.metric}"))
    plain(axis, grid="x")
    axis.tick_params(axis="y", labelcolor=BLACK)
    return figure
