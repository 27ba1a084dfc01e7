"""The errors of one picture of a face, by marker."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MarkerErrors:
    """The errors of one picture, by marker.

    Attributes
    ----------
    errors : dict of marker to float
        Millimetres; NaN without a sample.
    samples : dict of marker to int
        How many are behind each error.
    takes : int
    """

    errors: dict[str, float]
    samples: dict[str, int]
    takes: int
