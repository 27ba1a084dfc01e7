"""The usual facial layout: where its 60 markers sit on the average face."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Spot:
    """A place for one marker on the midline, or for a pair of markers.

    Attributes
    ----------
    region : str
    place : (u, v)
        On the average face, mm; for a pair that of the left one, u > 0.
    stable : bool
        Whether the muscles hardly move it.
    """

    region: str
    place: tuple[float, float]
    stable: bool = False


MIDLINE = (
    # The first are kept the longest when markers are few.
    Spot("nose", (0.0, 30.0), stable=True),
    Spot("jaw", (0.0, -74.0)),
    Spot("forehead", (0.0, 88.0), stable=True),
    Spot("mouth", (0.0, -44.0)),
    Spot("mouth", (0.0, -29.0)),
    Spot("nose", (0.0, -2.0), stable=True),
    Spot("forehead", (0.0, 64.0)),
    Spot("nose", (0.0, 13.0), stable=True),
)
PAIRS = (
    # The first two are always kept, the others by how well they spread.
    Spot("mouth", (27.0, -36.0)),
    Spot("temple", (66.0, 40.0), stable=True),
    Spot("brow", (10.0, 45.0)),
    Spot("brow", (22.0, 48.0)),
    Spot("brow", (35.0, 50.0)),
    Spot("brow", (48.0, 47.0)),
    Spot("eyelid", (26.0, 34.0)),
    Spot("eyelid", (37.0, 34.0)),
    Spot("eyelid", (31.0, 17.0)),
    Spot("eyelid", (49.0, 26.0)),
    Spot("nose", (10.0, 13.0)),
    Spot("nose", (14.0, -5.0)),
    Spot("cheek", (24.0, 3.0)),
    Spot("cheek", (45.0, 5.0)),
    Spot("cheek", (27.0, -16.0)),
    Spot("cheek", (42.0, -15.0)),
    Spot("cheek", (60.0, -18.0)),
    Spot("mouth", (10.0, -28.5)),
    Spot("mouth", (19.0, -31.5)),
    Spot("mouth", (13.0, -43.5)),
    Spot("jaw", (14.0, -59.0)),
    Spot("jaw", (32.0, -58.0)),
    Spot("jaw", (50.0, -47.0)),
    Spot("jaw", (21.0, -80.0)),
    Spot("forehead", (28.0, 84.0), stable=True),
    Spot("forehead", (52.0, 68.0), stable=True),
)
