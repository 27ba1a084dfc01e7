"""What is computed of a recording once, for all fills and settings that need it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any
from weakref import WeakKeyDictionary

from nodegraph_fill.filling import Filling
from nodegraph_mocap import Trajectories

_kept: WeakKeyDictionary[Trajectories, dict[Hashable, Any]] = WeakKeyDictionary()


def kept_of(recording: Trajectories) -> dict[Hashable, Any]:
    """Return what is kept of a recording as long as it lives; it may be added to.

    What is added must not refer to the recording, which would then live for ever.
    """
    return _kept.setdefault(recording, {})


def key_of(
    method: Callable[..., object], filling: Filling, settings: Mapping[str, Hashable]
) -> Hashable:
    """Return the key of what a method has for gaps, whether their ends are met or not."""
    return method, filling.max_gap, frozenset(settings.items())
