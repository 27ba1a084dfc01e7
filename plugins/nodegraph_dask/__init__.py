"""Run the steps of a graph on a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from nodegraph import NodegraphError, hookimpl


@hookimpl
def nodegraph_executors() -> Mapping[str, Callable[..., object]]:
    """Return the executor ``dask``."""
    return {"dask": dask}


def dask(schedule: Any, how: Any) -> Iterator[object]:
    """Make calls on a Dask cluster; the packages for it are imported when it is used."""
    try:
        from nodegraph_dask import executor
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("dask", "distributed"):
            raise
        raise NodegraphError(
            "the executor 'dask' needs packages that are not installed; "
            "pip install 'nodegraph[dask]'"
        ) from error
    return executor.dask(schedule, how)
