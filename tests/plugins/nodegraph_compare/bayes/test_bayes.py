from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from nodegraph import Across, Label, Refusal
from nodegraph_compare.bayes.node import bayes
from nodegraph_compare.inference import posterior
from nodegraph_mocap import Table
from nodegraph_tables import TableInfo, info_of, with_info


def study(actors: int = 8, blocks: int = 30) -> Across[Table]:
    """`b` is `a` but for noise, `c` twice as far off."""
    random = np.random.default_rng(0)
    entries: list[tuple[dict[str, Label], Table]] = []
    for actor in range(actors):
        base = random.lognormal(size=blocks)
        for fill, factor in (("a", 1.0), ("b", 1.0), ("c", 2.0)):
            rmse = base * factor * random.lognormal(0.0, 0.05, blocks)
            table = pd.DataFrame({"gap": range(blocks), "rmse": rmse})
            table = with_info(table, TableInfo(units={"rmse": "mm"}))
            entries.append(({"actor": actor, "fill": fill}, table))
    return Across(("actor", "fill"), tuple(entries), sources=("actor",))


def test_the_probabilities_are_those_of_the_model() -> None:
    scores = study()
    result = bayes(scores, baseline="a")
    values = {
        name: np.array([t["rmse"] for at, t in scores if at["fill"] == name]) for name in "abc"
    }
    for row in result.table.to_dict("records"):
        x, a = values[row["fill"]], values["a"]
        d = np.log(x.mean(axis=1) / a.mean(axis=1))
        within = x / x.mean(axis=1, keepdims=True) - a / a.mean(axis=1, keepdims=True)
        v = np.square(within).sum() / (8 * 29) / 30
        known = [row[name] for name in ("better", "equivalent", "worse")]
        assert known == pytest.approx(posterior(d, v, np.log(1.1)))
        new = [row[f"new actor {name}"] for name in ("better", "equivalent", "worse")]
        assert new == pytest.approx(posterior(d, v, np.log(1.1), new=True))
    sentence, scope, line = info_of(result.table).answer.lines
    assert sentence == "Of 2 comparisons, with a margin of 1.1: 1 equivalent, 1 worse."
    assert scope == "Scope: over 8 actors."
    assert "over 8 actors is equivalent: b (" in line
    assert "; worse: c (worse: 1.00)." in line
    assert len(result.figure.axes) == 1


def test_fewer_than_five_clusters_are_refused() -> None:
    with pytest.raises(Refusal, match="needs two methods in 5 actors; there are 4"):
        bayes(study(4))
    assert info_of(bayes(study(5)).table).answer.lines[-1].endswith("provisional, as of 5 actors.")


def test_methods_that_are_the_same_are_equivalent_for_certain() -> None:
    scores = study()
    twins = tuple(
        ({**at, "fill": name}, table) for at, table in scores if at["fill"] == "a" for name in "xy"
    )
    frame = bayes(Across(scores.axes, twins, sources=("actor",)), equivalent="0.01 mm").table
    assert frame[["better", "equivalent", "worse"]].to_numpy().tolist() == [[0.0, 1.0, 0.0]]
