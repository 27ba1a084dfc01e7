"""The workers of a Dask cluster, as they come and go."""

from __future__ import annotations

import time
import warnings

from nodegraph.errors import NodegraphError
from nodegraph.execute.elsewhere.dask_cluster import Cluster

LOOK = 0.5
"""Seconds between two looks."""
WAIT = 30.0
"""Seconds without any worker after which a run gives up."""


class Crew:
    """Counts the workers, and waits for new ones when all are gone.

    Attributes
    ----------
    threads : int
        Calls that they made at a time when they were last counted.
    """

    def __init__(self, cluster: Cluster) -> None:
        self._cluster = cluster
        self._looked = self._seen = time.monotonic()
        self._told = False
        self.threads = cluster.threads()

    def look(self, *, may_give_up: bool) -> bool:
        """Count the workers again, if that is due; return whether it was.

        Raises
        ------
        NodegraphError
            If none has been there for long.
        """
        if time.monotonic() - self._looked < LOOK:
            return False
        self._cluster.look_after()
        self.threads = self._cluster.threads()
        self._looked = time.monotonic()
        if self.threads:
            self._seen = self._looked
        else:
            self._wait(may_give_up)
        return True

    def _wait(self, may_give_up: bool) -> None:
        alone = time.monotonic() - self._seen
        if alone > WAIT and may_give_up:
            raise NodegraphError(f"{self._cluster.name} has had no worker for {WAIT:g} seconds")
        if alone > WAIT / 6 and not self._told:
            self._told = True
            warnings.warn(
                f"{self._cluster.name} has no worker; waiting {WAIT:g} seconds for one",
                stacklevel=2,
            )
