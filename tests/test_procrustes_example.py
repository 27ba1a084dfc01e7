"""The worked example of Procrustes analysis: command line to figure and table."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.studies import Studies, table

STEPS = {"original": 213.0, "translated": 30.0, "scaled": 12.0, "rotated": 0.0}


@pytest.fixture(scope="module")
def folder(studies: Studies) -> Path:
    return studies.few("procrustes_example")


def test_each_step_has_the_difference_of_the_text(folder: Path) -> None:
    differences = {row["align"]: float(row["mean"]) for row in table(folder / "table.csv")}
    assert list(differences) == list(STEPS)
    assert differences == pytest.approx(STEPS, abs=1e-12)


def test_the_figure_has_a_panel_per_step_with_its_difference(folder: Path) -> None:
    drawn = (folder / "figure-1.svg").read_text()
    for step, difference in STEPS.items():
        assert f">{step}<" in drawn
        assert f">D = {difference:.0f}<" in drawn
    assert (folder / "figure-1.pdf").is_file()
    report = (folder / "report.html").read_text()
    assert "triangles" in report
    assert "One frame, 3\N{NO-BREAK SPACE}markers: it is described" in report
