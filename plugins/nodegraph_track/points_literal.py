"""Points typed into a graph."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from nodegraph import Unit, node
from nodegraph_mocap import Trajectories

Frames = list[list[float]]


def _as_pydantic_says_it(points: dict[str, object]) -> dict[str, object]:
    mistakes = list(_mistakes(points))
    if mistakes:
        # What begins like this is shown to users as it is, names of markers included.
        text = "Input " + "; ".join(mistakes)
        raise PydanticCustomError("points", "{text}", {"text": text})
    return points


Points = Annotated[dict[str, Any], AfterValidator(_as_pydantic_says_it)]


@node("points.literal")
def literal(
    *,
    points: Annotated[Points, Unit("mm")],
    rate: Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("Hz")] = 1.0,
) -> Trajectories:
    """Give points that are typed into the graph, for examples and tests.

    Points in the plane get z = 0.

    Parameters
    ----------
    points
        Marker name to [x, y] or [x, y, z], or to a list of these, one per frame and as many for
        every marker. The markers keep their order.
    rate
        Frames per second.

    Returns
    -------
    Trajectories
        Every sample measured; no marker set.

    Raises
    ------
    ValueError
        If a marker has something else than finite numbers in such lists, the markers differ in
        their number of frames, or there is no marker; the message names the markers.

    Examples
    --------
    One frame of three markers, and two frames of two:

        first: {use: points.literal, with: {points: {a: [1, 1], b: [1, 2], c: [3, 2]}}}
        other: {use: points.literal, with: {points: {a: [[1, 1], [1, 2]], b: [[3, 2], [3, 4]]}}}
    """
    mistakes = list(_mistakes(points))
    if mistakes:
        raise ValueError(f"points {'; '.join(mistakes)}")
    columns = [[_in_space(point) for point in _frames(value)] for value in points.values()]
    return Trajectories(
        positions=np.array(columns, dtype=np.float64).transpose(1, 0, 2),
        markers=tuple(points),
        rate=rate,
    )


def _mistakes(points: Mapping[str, object]) -> Iterator[str]:
    if not points:
        yield "should name at least one marker"
    for marker, value in points.items():
        wrong = [point for point in _frames(value) if not _is_point(point)]
        if wrong:
            detail = f"for {marker!r}, not {wrong[0]!r}"
            yield f"should have [x, y] or [x, y, z] in finite numbers {detail}"
    counts = {marker: len(_frames(value)) for marker, value in points.items()}
    if len(set(counts.values())) > 1:
        detail = ", ".join(f"{marker!r} has {count}" for marker, count in counts.items())
        yield f"should have as many frames for every marker: {detail}"


def _frames(value: Any) -> Frames:
    """Return a list of points; a point by itself is one frame."""
    listed = isinstance(value, (list, tuple)) and value and isinstance(value[0], (list, tuple))
    return list(value) if listed else [value]


def _is_point(point: object) -> bool:
    return isinstance(point, (list, tuple)) and len(point) in (2, 3) and all(map(_is_number, point))


def _is_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond the largest float
        return False


def _in_space(point: list[float]) -> tuple[float, float, float]:
    x, y, *z = point
    return x, y, z[0] if z else 0.0
