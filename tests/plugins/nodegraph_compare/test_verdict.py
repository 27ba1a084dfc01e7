"""Verdicts as data: who is best, tied and behind, or why nobody is, whatever the numbers."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from nodegraph import Across, Label
from nodegraph_compare.overview.cards import answer_html
from nodegraph_compare.overview.pack import excerpt_of, packed
from nodegraph_compare.table.node import Compared, table
from nodegraph_compare.units import Kind, speech_of
from nodegraph_compare.verdict import Verdict
from nodegraph_mocap import Table
from nodegraph_tables import info_of
from nodegraph_tables.rendering import render_table
from nodegraph_tables.style import BEST


def verdict_on(values: NDArray[np.float64], **more: object) -> tuple[Verdict, Table]:
    """Compare methods by an array of (actors, methods, gaps)."""
    result = compared(values, **more)
    return result.overview.verdicts.groups[0], result.table


def compared(values: NDArray[np.float64], **more: object) -> Compared:
    """Compare methods by an array of (actors, methods, gaps)."""
    entries: list[tuple[dict[str, Label], Table]] = [
        ({"actor": actor, "fill": f"m{place}"}, pd.DataFrame({"gap": range(len(row)), "rmse": row}))
        for actor, rows in enumerate(values)
        for place, row in enumerate(rows)
    ]
    scores = Across(("actor", "fill"), tuple(entries), sources=("actor",))
    settings: dict[str, object] = {"metric": "rmse", "compare": "fill", **more}
    result: Compared = table(scores, **settings)
    return result


@pytest.mark.filterwarnings("ignore::UserWarning")
@settings(max_examples=25, deadline=None)
@given(
    arrays(np.float64, (6, 3, 2), elements=st.sampled_from([0.5, 1.0, 1.1, 4.0, np.nan])),
    st.booleans(),
)
def test_every_method_is_best_tied_or_behind_where_a_verdict_stands(
    values: NDArray[np.float64], filled: bool
) -> None:
    verdict, frame = verdict_on(values, fallback="m0" if filled else None)
    parts = [verdict.best, verdict.tied, verdict.behind]
    if not verdict.stands:
        assert not verdict.tied
        assert not verdict.behind
    else:
        assert sorted(place for part in parts for place in part) == verdict.known
    assert {*verdict.behind} <= {*verdict.worse_than_best}
    # the table marks what the verdict says
    best, tied = marks_of(verdict)
    for marks, names in ((info_of(frame).best, best), (info_of(frame).tied, tied)):
        assert {frame["fill"].iloc[row] for row in marks["mean"]} == names


def marks_of(verdict: Verdict) -> tuple[set[str], set[str]]:
    """Return the methods that are marked as the best, or, if several may be, these."""
    best, tied = ({f"m{place}" for place in places} for places in (verdict.best, verdict.tied))
    if not verdict.behind:
        return set(), set()
    return (set(), best | tied) if tied else (best, set())


@pytest.mark.filterwarnings("ignore::UserWarning")
@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([1, 3, 4, 6, 9]), st.sampled_from([0.0, 0.3, 2.0]))
def test_every_place_marks_what_the_verdict_tells_and_nothing_else(
    seed: int, actors: int, apart: float
) -> None:
    random = np.random.default_rng(seed)
    values = np.exp(random.normal(size=(actors, 4, 3)) + apart * np.arange(4)[:, np.newaxis])
    result = compared(values)
    verdicts = result.overview.verdicts
    (verdict,) = verdicts.groups
    best, tied = marks_of(verdict)
    assert verdict.stands or not best | tied
    shown = render_table(result.table, "")
    assert set(re.findall(r"(m\d).*?\\textbf", shown.files[".tex"].decode())) == best
    assert set(re.findall(r"(m\d).*\*", shown.text)) == best
    assert (
        set(re.findall(r"<tr[^>]*data-method=\"(m\d)\"(?:(?!</tr>).)*<strong>", shown.html)) == best
    )
    data = packed(result.overview, verdicts, excerpt_of(result.overview), "table", {})
    (group,) = data["groups"]
    assert {f"m{place}" for place in group["best"]} == {
        f"m{place}" for place in verdict.best if verdict.behind
    }
    assert {f"m{place}" for place in group["tied"]} == tied
    lead = answer_html(result.overview.answer, verdicts, {})
    for kind, names in (("best", best), ("tied", tied)):
        assert set(re.findall(rf'<circle class="{kind}"[^>]*><title>(m\d) ', lead)) == names
    blue = {
        text.get_text()
        for text in result.figure.axes[0].get_yticklabels()
        if text.get_color() == BEST
    }
    assert blue == best


@pytest.mark.parametrize(
    ("kind", "counts"),
    [
        ("clusters", {"nothing": (0, 2), "described": (3, 4), "provisional": (5, 7)}),
        ("segments", {"nothing": (0, 2), "described": (3, 4), "provisional": (5, 7)}),
        ("draws", {"nothing": (0, 2), "provisional": (3, 7), "settled": (8, 100)}),
    ],
)
def test_the_number_of_units_decides_what_may_be_said(
    kind: Kind, counts: dict[str, tuple[int, int]]
) -> None:
    for speech, ends in counts.items():
        assert [speech_of(kind, count) for count in ends] == [speech] * 2
