"""The walk of the question about impulses, as a user takes it: command line to report."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path

import pytest

from tests.studies import Studies, table

DESPIKERS = {"impulse", "redetect", "hampel", "median", "acceleration", "wavelet", "no_repair"}
GROUPS = tuple(f"size {size}, impulses {share}" for size in (2.0, 5.0) for share in (0.005, 0.02))
TABLES = ("wrong-samples", "error-left", "impulses-missed", "good-samples-repaired")


def means_of(folder: Path, name: str) -> dict[tuple[str, str], float]:
    """Return the means by method, size and share: ``size 5.0, impulses 0.02``."""
    rows = table(folder / f"{name}_table.csv")
    return {
        (row["despike"], f"size {row['size']}, impulses {row['impulses']}"): float(row["mean"])
        for row in rows
    }


@pytest.fixture(scope="module")
def built_in(studies: Studies) -> Path:
    """A run on two faces."""
    return studies.few("impulses")


def test_the_tables_have_every_method_at_every_size_and_share(built_in: Path) -> None:
    expected = set(product(DESPIKERS, GROUPS))
    for name in TABLES:
        assert set(means_of(built_in, name)) >= expected


def test_everything_that_the_walk_promises_is_there(built_in: Path) -> None:
    names = {path.name for path in built_in.iterdir()}
    files = {"report.html", "run.json", "events.jsonl", "graph.yaml"}
    tables = {f"{name}_table.{form}" for name in TABLES for form in ("csv", "tex")}
    drawn = [*(f"{name}_figure" for name in TABLES[:2]), "before-and-after", "every-method"]
    figures = {f"{name}.{form}" for name in drawn for form in ("svg", "pdf")}
    assert files | tables | figures <= names
    assert json.loads((built_in / "run.json").read_text())["counts"]["failed"] == 0


def test_the_report_answers_and_cites(built_in: Path) -> None:
    html = (built_in / "report.html").read_text()
    assert "Which method finds impulses and nothing else?" in html
    for cited in ("Scattered data processing", "Vector median filters", "wavelet shrinkage"):
        assert cited in html
    assert 'src="http' not in html


def test_the_rule_of_the_paper_misses_nothing_and_pays_for_it(built_in: Path) -> None:
    missed = means_of(built_in, "impulses-missed")
    wrong = means_of(built_in, "good-samples-repaired")
    samples = means_of(built_in, "wrong-samples")
    for method in DESPIKERS:
        key = method, "size 5.0, impulses 0.02"
        of_all = 0.02 * missed[key] + 0.98 * wrong[key]
        assert samples[key] == pytest.approx(100_000 * of_all, rel=0.01)
    # what is left besides the noise of 0.1 mm that was added, mm^2
    error = {key: rmse**2 - 0.03 for key, rmse in means_of(built_in, "error-left").items()}
    for share in ("size 5.0, impulses 0.005", "size 5.0, impulses 0.02"):
        assert missed["impulse", share] == 0.0
        assert missed["no_repair", share] == 1.0
        assert wrong["no_repair", share] == 0.0
        # It takes some 1 to 4 in a hundred good samples for impulses, its rivals hardly any.
        assert 0.01 < wrong["impulse", share] < 0.05
        for rival in DESPIKERS - {"impulse", "redetect", "acceleration", "no_repair"}:
            assert wrong[rival, share] < 0.001
        assert error["redetect", share] < 0.6 * error["impulse", share]
        assert error["impulse", share] < 0.3 * error["no_repair", share]
        assert error["wavelet", share] < 0.2 * error["impulse", share]
    # a jump of 5 mm and back is too fast for a face in three frames, of which two are good
    assert wrong["acceleration", "size 5.0, impulses 0.02"] == pytest.approx(0.04, abs=0.002)


def test_no_threshold_is_blind_to_the_impulses_of_the_study(built_in: Path) -> None:
    missed = means_of(built_in, "impulses-missed")
    for method in DESPIKERS - {"no_repair", "hampel"}:
        assert missed[method, "size 2.0, impulses 0.005"] < 0.05
    assert missed["hampel", "size 2.0, impulses 0.005"] < 0.4
