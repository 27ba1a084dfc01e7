"""A score that breaks a promise is caught."""

from __future__ import annotations

import numpy as np
import pytest

import nodegraph_mocap
import nodegraph_score
from nodegraph import Truth, node
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from nodegraph_mocap import Table, Trajectories
from nodegraph_tables import TableInfo, with_info

REGISTRY = Registry(loaded=[Plugin("mocap", nodegraph_mocap), Plugin("score", nodegraph_score)])


def distances(estimate: Trajectories, truth: Trajectories) -> Table:
    from pandas import DataFrame

    apart = np.linalg.norm(estimate.positions - truth.positions, axis=2)
    table = DataFrame({"marker": truth.markers, "worst": apart.max(axis=0, initial=0.0)})
    table = with_info(table, TableInfo(units={"worst": "mm"}))
    return table


def test_a_good_score_passes() -> None:
    @node("score.worst")
    def worst(estimate: Trajectories, truth: Truth[Trajectories]) -> Table:
        """Largest distance of each marker."""
        return distances(estimate, truth)

    check_node(worst, registry=REGISTRY)


def test_an_error_where_there_is_none() -> None:
    @node("score.broken")
    def broken(estimate: Trajectories, truth: Truth[Trajectories]) -> Table:
        """Largest distance of each marker, and a millimetre."""
        table = distances(estimate, truth)
        table["worst"] += 1.0
        return table

    with pytest.raises(AssertionError, match="column 'worst' has 1 mm"):
        check_node(broken, registry=REGISTRY)


def test_a_score_without_a_table() -> None:
    @node("score.broken")
    def broken(estimate: Trajectories) -> Trajectories:
        """Return no score."""
        return estimate

    with pytest.raises(AssertionError, match="not a pandas DataFrame"):
        check_node(broken, registry=REGISTRY)
