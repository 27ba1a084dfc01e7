"""The figure of what PCA finds has a panel per recording, called as the recording is."""

from __future__ import annotations

import io

import pytest
from pandas import DataFrame

from nodegraph_mocap import Table
from nodegraph_score.alignment_figure import draw


def table(*names: str) -> Table:
    """Return two components of each recording."""
    return DataFrame(
        {
            "align": [name for name in names for _ in range(2)],
            "component": [1, 2] * len(names),
            "share": [0.7, 0.3] * len(names),
            "head motion": [0.9, -0.1] * len(names),
        }
    )


@pytest.mark.parametrize(
    ("name", "title"),
    [
        ("procrustes", "procrustes"),
        (r"$\frac$", r"\$\frac\$"),
        ("pay $1 or $2", r"pay \$1 or \$2"),
        ("two\nlines", "two lines"),
        ("all steps of the long alignment", "all steps of the long\nalignment"),
    ],
)
def test_a_panel_is_called_as_its_recording(name: str, title: str) -> None:
    figure = draw(table(name, "other"), ("align",))
    assert [axis.get_title("left") for axis in figure.axes] == [title, "other"]
    for form in ("svg", "pdf"):
        figure.savefig(io.BytesIO(), format=form)


def test_a_bar_is_filled_as_far_as_head_motion_makes_it() -> None:
    (axis,) = draw(table("one"), ("align",)).axes
    unit = axis.transData.transform((0, 1))[1] - axis.transData.transform((0, 0))[1]
    heights = [patch.get_window_extent().height / unit for patch in axis.patches]
    assert heights == pytest.approx([0.7, 0.3, 0.63, 0.0])
