"""Large buffers on a cluster: each is sent once, however many calls need it."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import Any

import numpy as np

from nodegraph.executors import Frame
from nodegraph_dask.worker import as_array

_LARGE_REQUEST = 500_000
"""Bytes from which the buffers of a request are scattered."""
_LARGE_BUFFER = 64_000


class Scattered:
    """Buffers that the cluster has, by their place in the memory of this process."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._futures: dict[tuple[int, int], tuple[Any, weakref.ref[Any]]] = {}

    def arguments(self, buffers: Sequence[Frame]) -> list[Any]:
        """Return each buffer as an argument of a call: as an array, or as a future of it."""
        arrays = [as_array(buffer) for buffer in buffers]
        if sum(array.nbytes for array in arrays) < _LARGE_REQUEST:
            return list(arrays)
        return [self._future(array) if array.nbytes >= _LARGE_BUFFER else array for array in arrays]

    def _future(self, array: Any) -> Any:
        place = (array.ctypes.data, array.nbytes)
        known = self._futures.get(place)
        if known is not None and known[1]() is not None and known[0].status == "finished":
            return known[0]
        try:
            future = self._client.scatter([array], hash=False, timeout=5)[0]
        except TimeoutError:  # no worker can take it now
            return array
        owner = weakref.ref(_owner(array), lambda _: self._futures.pop(place, None))
        self._futures[place] = (future, owner)
        return future


def _owner(array: Any) -> Any:
    """Return the array that lives as long as the memory is in use."""
    while isinstance(getattr(array.base, "obj", array.base), np.ndarray):
        array = getattr(array.base, "obj", array.base)
    return array
