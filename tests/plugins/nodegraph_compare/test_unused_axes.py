"""Axes that only some methods have are named, with the methods that they concern."""

from __future__ import annotations

from itertools import product

import pandas as pd
import pytest

from nodegraph import Across, Label, get_node
from nodegraph_compare.table.node import table
from nodegraph_compare.unused_axes import unused_axes
from nodegraph_mocap import Table
from nodegraph_tables import info_of
from tests.plugins.recordings import quietly

AXES = ("fill", "neighbours", "trial")


def gathered(unused: dict[str, tuple[str, ...]]) -> Across[Table]:
    """Return errors of three methods for two numbers of neighbours in four trials."""
    entries: list[tuple[dict[str, Label], Table]] = []
    each = []
    for fill, neighbours, trial in product(("mean", "muscle", "ridge"), (3, 8), range(4)):
        names = unused.get(fill, ())
        rmse = len(fill) + 0.1 * (0 if names else neighbours) + trial**2
        labels: dict[str, Label] = {"fill": fill, "neighbours": neighbours, "trial": trial}
        entries.append((labels, pd.DataFrame({"rmse": [rmse]})))
        each.append(names)
    return Across(AXES, tuple(entries), unused=tuple(each) if any(each) else ())


@pytest.mark.parametrize(
    ("unused", "compare", "names"),
    [
        ({}, "fill", ()),
        (
            {"muscle": ("neighbours",), "ridge": ("neighbours",)},
            "fill",
            ("only mean depends on neighbours", "muscle, ridge count", "2 labels"),
        ),
        (
            {"muscle": ("neighbours",), "ridge": ("neighbours",)},
            "neighbours",
            ("only mean depends on neighbours",),
        ),
        ({"ridge": ("neighbours",)}, "fill", ("only mean, muscle depend on", "ridge counts")),
        (
            {name: ("neighbours",) for name in ("mean", "muscle", "ridge")},
            "fill",
            ("nothing depends on neighbours",),
        ),
    ],
)
def test_the_methods_that_an_axis_concerns_are_named(
    unused: dict[str, tuple[str, ...]], compare: str, names: tuple[str, ...]
) -> None:
    scores = gathered(unused)
    sentences = unused_axes(scores, compare)
    assert list(sentences) == ["neighbours"] * bool(names)
    assert all(name in " ".join(sentences.values()) for name in names)
    info = info_of(table(scores, compare=compare, blocks=("trial",)).table)
    assert all(name in " ".join(info.notes) for name in names)
    averaged = compare != "neighbours" and bool(names)
    assert any("depend" in sentence for sentence in info.answer.more) == averaged


@pytest.mark.parametrize(
    ("node", "settings"),
    [("compare.ranks", {}), ("compare.curve", {"x": "neighbours"})],
)
def test_every_comparison_names_them(node: str, settings: dict[str, str]) -> None:
    scores = gathered({"ridge": ("neighbours",)})
    result = quietly(get_node(node), scores, compare="fill", **settings)
    assert "only mean, muscle depend on neighbours" in " ".join(info_of(result.table).notes)
