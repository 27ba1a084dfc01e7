"""Checks that several values share, each with a message that says what is wrong."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed, read_only

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import ArrayLike, NDArray


SLOWEST, FASTEST = 1e-3, 1e6
"""Rates in Hz, beyond which a recording is refused."""


def set_fields(record: object, **values: object) -> None:
    """Set fields of a frozen record while it is being made; arrays become read-only."""
    for name, value in values.items():
        locked = read_only(value) if isinstance(value, np.ndarray) else value
        object.__setattr__(record, name, locked)


def numbers(what: str, array: ArrayLike, shape: Sequence[int | str]) -> NDArray[np.float64]:
    """Return the array as float64, of that shape and without infinities.

    Parameters
    ----------
    what
        The name of the array in messages.
    array
        The numbers; NaN stays.
    shape
        A length per axis, or a word for an axis of any length.

    Raises
    ------
    ValueError
        If the shape differs or a number is infinite.
    """
    checked = np.asarray(array, dtype=np.float64)
    _check_shape(what, checked.shape, shape)
    if np.isinf(checked).any():
        place = tuple(int(index) for index in np.argwhere(np.isinf(checked))[0])
        raise ValueError(f"{what}: infinite at {place}")
    return checked


def finite(what: str, array: ArrayLike, shape: Sequence[int | str]) -> NDArray[np.float64]:
    """Return the array as float64, of that shape; a missing number is an error as well."""
    checked = numbers(what, array, shape)
    if np.isnan(checked).any():
        place = tuple(int(index) for index in np.argwhere(np.isnan(checked))[0])
        raise ValueError(f"{what}: missing (NaN) at {place}; every number is needed here")
    return checked


def indices(
    what: str, array: ArrayLike, shape: Sequence[int | str], *, count: int
) -> NDArray[np.int64]:
    """Return the array as whole numbers from 0 to `count` - 1; any other is a ValueError."""
    values = np.asarray(array)
    _check_shape(what, values.shape, shape)
    if values.size and not np.issubdtype(values.dtype, np.integer):
        raise ValueError(f"{what}: must be whole numbers, got {values.dtype}")
    if values.size and (values.min() < 0 or values.max() >= count):
        raise ValueError(
            f"{what}: must lie in 0 to {count - 1}, got {values.min()} to {values.max()}"
        )
    return values.astype(np.int64)


def distinct(what: str, names: Iterable[str]) -> tuple[str, ...]:
    """Return the names as a tuple; one that stands twice, or is no text, is a ValueError."""
    texts = tuple(names)
    for name in texts:
        if not isinstance(name, str):
            raise ValueError(f"{what}: names are texts, not {name!r}")
    if len(set(texts)) < len(texts):
        raise ValueError(f"{what}: named twice: {listed(twice(texts))}")
    return texts


def twice(names: Iterable[str]) -> list[str]:
    """Return the names that stand there more than once, sorted."""
    return sorted(name for name, count in Counter(names).items() if count > 1)


def possible_rate(rate: float) -> float:
    """Return the rate in frames per second; one not from 0.001 to 1e6 is a ValueError."""
    if not SLOWEST <= rate <= FASTEST:
        raise ValueError(f"rate must be from 0.001 to 1e6 frames per second, got {rate}")
    return float(rate)


def _check_shape(what: str, got: tuple[int, ...], wanted: Sequence[int | str]) -> None:
    fits = len(got) == len(wanted) and all(
        isinstance(length, str) or length == size for length, size in zip(wanted, got, strict=True)
    )
    if not fits:
        text = ", ".join(str(length) for length in wanted)
        raise ValueError(f"{what}: must be ({text}), got {got}")
