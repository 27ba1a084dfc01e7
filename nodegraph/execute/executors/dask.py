"""Many calls at a time, on a Dask cluster: one that runs somewhere, or one on this machine."""

from __future__ import annotations

from collections.abc import Iterator

from nodegraph.errors import NodegraphError
from nodegraph.execute.call import Outcome
from nodegraph.execute.executors.protocol import HowToRun
from nodegraph.execute.schedule import Schedule

try:
    from nodegraph.execute.elsewhere.dask_calls import outcomes_of
    from nodegraph.execute.elsewhere.dask_cluster import cluster_for
except ModuleNotFoundError as error:
    if (error.name or "").partition(".")[0] not in ("dask", "distributed"):
        raise
    raise NodegraphError(
        "the executor 'dask' needs what is not installed; pip install 'nodegraph[dask]'"
    ) from error


def dask(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make calls on the cluster at ``how.scheduler``, else on one that is started for the run.

    On a cluster that others have started, calls are as many as its workers have threads. A call
    whose node or values cannot go to another process, or that reads a file, is made here. Workers
    may come and go; a call whose worker dies is made again by another one.
    """
    first = schedule.next()
    if first is None:
        return  # for nothing, no cluster is started
    with cluster_for(how) as cluster:
        yield from outcomes_of(schedule, first, cluster)
