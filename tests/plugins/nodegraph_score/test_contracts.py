"""A score that breaks a promise is caught."""

from __future__ import annotations

import numpy as np

from nodegraph import Truth
from nodegraph_mocap import Table, Trajectories
from nodegraph_tables import TableInfo, with_info
from tests.promises import Family

SCORE = Family("score")


def distances(estimate: Trajectories, truth: Trajectories) -> Table:
    from pandas import DataFrame

    apart = np.linalg.norm(estimate.positions - truth.positions, axis=2)
    table = DataFrame({"marker": truth.markers, "worst": apart.max(axis=0, initial=0.0)})
    table = with_info(table, TableInfo(units={"worst": "mm"}))
    return table


def test_a_good_score_passes() -> None:
    def worst(estimate: Trajectories, truth: Truth[Trajectories]) -> Table:
        """Largest distance of each marker."""
        return distances(estimate, truth)

    SCORE.accepts(worst)


def test_an_error_where_there_is_none() -> None:
    def broken(estimate: Trajectories, truth: Truth[Trajectories]) -> Table:
        """Largest distance of each marker, and a millimetre."""
        table = distances(estimate, truth)
        table["worst"] += 1.0
        return table

    SCORE.refuses(broken, "column 'worst' has 1 mm")


def test_a_score_without_a_table() -> None:
    def broken(estimate: Trajectories) -> Trajectories:
        """Return no score."""
        return estimate

    SCORE.refuses(broken, "not a pandas DataFrame")
