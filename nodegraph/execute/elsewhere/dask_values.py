"""Large buffers on the cluster: sent once, for as long as somebody here has their value."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import Any

import numpy as np

from nodegraph.execute.elsewhere.dask_work import as_bytes_array
from nodegraph.execute.elsewhere.frames import Frame

_LARGE = 500_000
_SMALL = 64_000


class SentOnce:
    """Buffers that the cluster has, by where they lie here."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._sent: dict[tuple[int, int], tuple[Any, weakref.ref[Any]]] = {}

    def arguments(self, buffers: Sequence[Frame]) -> list[Any]:
        """Return each buffer as what goes along with a call: itself, or a future of it."""
        arrays = [as_bytes_array(one) for one in buffers]
        if sum(one.nbytes for one in arrays) < _LARGE:
            return list(arrays)
        return [self._future(one) if one.nbytes >= _SMALL else one for one in arrays]

    def _future(self, array: Any) -> Any:
        at = (array.ctypes.data, array.nbytes)
        known = self._sent.get(at)
        if known is not None and known[1]() is not None and known[0].status == "finished":
            return known[0]
        try:
            future = self._client.scatter([array], hash=False, timeout=5)[0]
        except TimeoutError:  # no worker is there to take it: the scheduler does
            return array
        owner = weakref.ref(_owner(array), lambda _: self._sent.pop(at, None))
        self._sent[at] = (future, owner)
        return future


def _owner(array: Any) -> Any:
    """Return the array that lives as long as the memory is in use."""
    while isinstance(getattr(array.base, "obj", array.base), np.ndarray):
        array = getattr(array.base, "obj", array.base)
    return array
