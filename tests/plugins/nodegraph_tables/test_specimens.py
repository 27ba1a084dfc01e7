"""Tables and figures on which nodes are tested."""

from __future__ import annotations

import nodegraph_mocap
from nodegraph_tables import nodegraph_kinds
from nodegraph_tables.specimens import table_specimens


def test_tables_hold_scores_that_are_there_and_scores_that_are_not() -> None:
    tables = table_specimens()
    assert tables["complete"]["rmse"].notna().all()
    assert tables["gaps"]["rmse"].isna().any()
    assert tables["all missing"]["rmse"].isna().all()
    assert len(tables["nothing hidden"]) == 0


def test_every_type_has_specimens_of_that_type() -> None:
    for kind in (*nodegraph_kinds(), *nodegraph_mocap.nodegraph_kinds()):
        if kind.specimens is not None:
            values = kind.specimens().values()
            assert values
            assert all(isinstance(value, kind.type) for value in values)
