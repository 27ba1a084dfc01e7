"""Settings in plain calls: a graph's are checked when it is loaded."""

from __future__ import annotations

from numbers import Integral


def check_whole(name: str, value: int, least: int) -> None:
    """Raise a ValueError unless a setting is a whole number that is large enough."""
    if not isinstance(value, Integral) or value < least:
        raise ValueError(f"{name} must be a whole number from {least} on, got {value!r}")


def check_share(name: str, value: float) -> None:
    """Raise a ValueError unless a setting is above 0 and at most 1."""
    if not 0.0 < value <= 1.0:
        raise ValueError(f"{name} must be above 0 and at most 1, got {value!r}")
