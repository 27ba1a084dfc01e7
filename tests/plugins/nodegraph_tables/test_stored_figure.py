from __future__ import annotations

import xml.etree.ElementTree as ET

from matplotlib.figure import Figure

from nodegraph_tables import StoredFigure
from nodegraph_tables.renderers import saved


def test_a_notebook_shows_the_drawing() -> None:
    figure = Figure(figsize=(2, 1))
    figure.subplots().set_title("seen")
    stored = StoredFigure(saved(figure, "svg"), saved(figure, "pdf"))
    shown = ET.fromstring(stored._repr_html_())
    assert shown.tag == "figure"
    assert "seen" in "".join(shown.itertext())
