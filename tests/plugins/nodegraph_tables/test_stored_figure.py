from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

import pytest
from matplotlib.figure import Figure

from nodegraph_mocap import StoredFigure
from nodegraph_tables.renderers import saved


@pytest.mark.parametrize(
    "drawing", [(b"", b""), (b"\xff<svg", b""), ("<svg>", b""), (b"<svg>", "")]
)
def test_what_is_no_drawing_is_refused(drawing: Any) -> None:
    with pytest.raises(ValueError, match=r"svg|pdf|utf-8"):
        StoredFigure(*drawing)


def test_a_notebook_shows_the_drawing() -> None:
    figure = Figure(figsize=(2, 1))
    figure.subplots().set_title("seen")
    stored = StoredFigure(saved(figure, "svg"), saved(figure, "pdf"))
    shown = ET.fromstring(stored._repr_html_())
    assert shown.tag == "figure"
    assert "seen" in "".join(shown.itertext())
