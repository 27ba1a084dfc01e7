"""Small tables and figures, on which nodes are tested."""

from __future__ import annotations

import numpy as np

from nodegraph_tables.info import TableInfo, with_info
from nodegraph_tables.types import Figure, Table


def table_specimens() -> dict[str, Table]:
    """Return tables of scores, a row per gap."""
    from pandas import DataFrame

    errors = {
        "complete": [0.5, 1.25, 0.75, 2.0, 1.5],
        "gaps": [0.5, np.nan, 0.75, 2.0],
        "all missing": [np.nan, np.nan],
        "one frame": [0.25],
        "nothing hidden": [],
    }
    specimens = {}
    for name, rmse in errors.items():
        gap = np.arange(len(rmse))
        table = DataFrame(
            {
                "gap": gap,
                "marker": np.array(["brow", "cheek", "lip", "nose", "jaw"], dtype=object)[gap],
                "start": 10 * gap,
                "frames": 5 + gap,
                "rmse": np.array(rmse, dtype=np.float64),
                "filled": np.isfinite(np.array(rmse, dtype=np.float64)).astype(np.float64),
            }
        )
        specimens[name] = with_info(table, TableInfo(title="Errors in gaps", units={"rmse": "mm"}))
    return specimens


def figure_specimens() -> dict[str, Figure]:
    """Return a figure."""
    from matplotlib.figure import Figure as Drawing

    figure = Drawing(figsize=(2, 1))
    figure.add_subplot().plot([0, 1, 2], [0, 1, 0])
    return {"complete": figure}
