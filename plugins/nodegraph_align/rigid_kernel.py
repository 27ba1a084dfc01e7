"""The loops that fit and move rigid shapes, compiled: import this module only when it runs.

All that is compiled stays in this one file, because numba's cache does not notice an edited
helper in another one. A missing sample is NaN, and does not equal itself.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Codes = NDArray[np.uint8]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

compiled = partial(kernel, fastmath={"contract"})
inlined = partial(kernel, fastmath={"contract"}, forceinline=True, no_cpython_wrapper=True)

Vector = tuple[float, float, float]

FITTED, MIRRORED, FEW, LINE = 0, 1, 2, 3
AS_IT_IS, RMS, LEAST_SQUARES = 0, 1, 2
ON_A_LINE = 1e-3
"""Second singular value of the covariance to the first, below which there is no rotation."""

IN_ONE_PLACE = 1e-9
"""Extent relative to the distance from the origin, below which it is rounding."""

ROUNDING = 1e-15
SWEEPS = 10


@compiled()
def fit(
    positions: Floats,
    columns: Integers,
    shape: Floats,
    weights: Floats,
    scaling: int,
    reflection: bool,
) -> tuple[Floats, Floats, Floats, Floats, Codes]:
    """Fit each frame's landmarks to a shape, by weighted least squares over those that are there.

    Parameters
    ----------
    positions : (T, M, 3) array of float64
    columns : (L,) array of int
        The landmarks among the M.
    shape : (L, 3) array of float64
        Where they belong.
    weights : (T, L) array of float64, or (1, L) for all frames
    scaling
        `AS_IT_IS`, `RMS` or `LEAST_SQUARES`.
    reflection
        Whether a mirror image may be chosen where it fits better.

    Returns
    -------
    rotations (T, 3, 3), scales (T,), centres (T, 3), goals (T, 3), states (T,)
        ``scale R (x - centre) + goal`` is where a point x of the frame belongs: where it is, in
        a frame whose state is `FEW` or `LINE`.
    """
    frames = len(positions)
    rotations, scales = np.empty((frames, 3, 3)), np.empty(frames)
    centres, goals = np.empty((frames, 3)), np.empty((frames, 3))
    states = np.empty(frames, np.uint8)
    points, there = np.empty_like(shape), np.empty(len(shape))
    for frame in range(frames):
        own = weights[frame if len(weights) > 1 else 0]
        _gather(points, there, positions[frame], columns, own)
        scales[frame], states[frame] = _pose(
            rotations[frame], centres[frame], goals[frame], points, shape, there,
            scaling, reflection,
        )  # fmt: skip
        if states[frame] >= FEW:
            for i in range(3):
                centres[frame, i] = goals[frame, i] = 0.0
                for j in range(3):
                    rotations[frame, i, j] = 1.0 if i == j else 0.0
    return rotations, scales, centres, goals, states


@compiled("out")
def move(
    out: Floats,
    positions: Floats,
    rotations: Floats,
    scales: Floats,
    centres: Floats,
    goals: Floats,
    states: Codes,
) -> tuple[Floats, Floats, Floats]:
    """Write where every point x belongs, ``scale R (x - centre) + goal``; return the way back.

    Parameters
    ----------
    out, positions : (T, M, 3) arrays of float64
    rotations, scales, centres, goals, states
        As from `fit`.

    Returns
    -------
    rotations (T, 3, 3), translations (T, 3), scales (T,)
        ``scale R x + translation`` takes what was moved back where it was.
    """
    back, offsets = np.empty(rotations.shape), np.empty(goals.shape)
    shrinkage, matrix, offset = np.empty(len(scales)), np.empty((3, 3)), np.empty(3)
    for frame in range(len(positions)):
        scale = scales[frame] if states[frame] < FEW else 1.0
        for i in range(3):
            offset[i] = goals[frame, i] if states[frame] < FEW else 0.0
            for j in range(3):
                matrix[i, j] = scale * rotations[frame, i, j]
                if states[frame] >= FEW:
                    matrix[i, j] = 1.0 if i == j else 0.0
                else:
                    offset[i] -= matrix[i, j] * centres[frame, j]
        _move(out[frame], positions[frame], matrix, offset)
        for i in range(3):
            offsets[frame, i] = 0.0
            for j in range(3):
                back[frame, i, j] = matrix[j, i] / scale
                offsets[frame, i] -= back[frame, i, j] * offset[j]
            offsets[frame, i] /= scale
        shrinkage[frame] = 1.0 / scale
    return back, offsets, shrinkage


@compiled("out")
def move_into(out: Floats, positions: Floats, matrices: Floats, offsets: Floats) -> None:
    """Write ``matrix x + offset`` for every point x of a frame.

    Parameters
    ----------
    out, positions : (T, M, 3) arrays of float64
    matrices : (T, 3, 3) array of float64
    offsets : (T, 3) array of float64
    """
    for frame in range(len(positions)):
        _move(out[frame], positions[frame], matrices[frame], offsets[frame])


@inlined("out")
def _move(out: Floats, points: Floats, a: Floats, b: Floats) -> None:
    """Write ``a x + b`` for every point x."""
    for marker in range(len(points)):
        x, y, z = points[marker]
        out[marker, 0] = a[0, 0] * x + a[0, 1] * y + a[0, 2] * z + b[0]
        out[marker, 1] = a[1, 0] * x + a[1, 1] * y + a[1, 2] * z + b[1]
        out[marker, 2] = a[2, 0] * x + a[2, 1] * y + a[2, 2] * z + b[2]


@inlined("points", "weights")
def _gather(points: Floats, weights: Floats, frame: Floats, columns: Integers, own: Floats) -> None:
    """Write a frame's landmarks and their weights; a missing one is at 0 with weight 0."""
    for landmark in range(len(columns)):
        x, y, z = frame[columns[landmark]]
        there = x == x
        weights[landmark] = own[landmark] if there else 0.0
        points[landmark, 0] = x if there else 0.0
        points[landmark, 1] = y if there else 0.0
        points[landmark, 2] = z if there else 0.0


@inlined("rotation", "centre", "goal")
def _pose(
    rotation: Floats,
    centre: Floats,
    goal: Floats,
    points: Floats,
    shape: Floats,
    weights: Floats,
    scaling: int,
    reflection: bool,
) -> tuple[float, int]:
    """Write what takes weighted points onto a shape; return the scale and the state."""
    count, total = 0, 0.0
    for i in range(len(weights)):
        count += weights[i] > 0.0
        total += weights[i]
    if count < 3:
        return 1.0, FEW
    x, y = _mean(points, weights, total), _mean(shape, weights, total)
    a, b, c, size, aim = _covariance(points, shape, weights, x, y)
    if _is_small(size, total, x) or _is_small(aim, total, y):
        return 1.0, LINE
    first, second, third = _rotation(rotation, a, b, c, reflection)
    if second <= ON_A_LINE * first:
        return 1.0, LINE
    for axis in range(3):
        centre[axis], goal[axis] = x[axis], y[axis]
    fitted, mirrored, whole = first + second + third, first + second - third, math.sqrt(size * aim)
    scale = 1.0
    if scaling == RMS:
        scale = math.sqrt(aim / size)
    elif scaling == LEAST_SQUARES:
        scale = fitted / size
    # half the squared distances of shapes of one size: the mirror image is less than half as far
    inside_out = whole - fitted > max(5e-5 * whole, 4.0 * (whole - mirrored))
    return scale, MIRRORED if inside_out else FITTED


@inlined()
def _mean(points: Floats, weights: Floats, total: float) -> Vector:
    x, y, z = 0.0, 0.0, 0.0
    for i in range(len(weights)):
        x += weights[i] * points[i, 0]
        y += weights[i] * points[i, 1]
        z += weights[i] * points[i, 2]
    return x / total, y / total, z / total


@inlined()
def _covariance(
    points: Floats, shape: Floats, weights: Floats, centre: Vector, goal: Vector
) -> tuple[Vector, Vector, Vector, float, float]:
    """Return the columns of ``sum(w (p - centre) (q - goal)^T)``, and the squared sizes of both."""
    xu, yu, zu, xv, yv, zv, xw, yw, zw = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    size, aim = 0.0, 0.0
    for i in range(len(weights)):
        weight = weights[i]
        x, y, z = points[i, 0] - centre[0], points[i, 1] - centre[1], points[i, 2] - centre[2]
        u, v, w = shape[i, 0] - goal[0], shape[i, 1] - goal[1], shape[i, 2] - goal[2]
        size += weight * (x * x + y * y + z * z)
        aim += weight * (u * u + v * v + w * w)
        x, y, z = weight * x, weight * y, weight * z
        xu, yu, zu = xu + x * u, yu + y * u, zu + z * u
        xv, yv, zv = xv + x * v, yv + y * v, zv + z * v
        xw, yw, zw = xw + x * w, yw + y * w, zw + z * w
    return (xu, yu, zu), (xv, yv, zv), (xw, yw, zw), size, aim


@inlined()
def _is_small(size: float, total: float, middle: Vector) -> bool:
    return bool(size <= IN_ONE_PLACE * IN_ONE_PLACE * total * _dot(middle, middle))


@inlined("rotation")
def _rotation(
    rotation: Floats, a: Vector, b: Vector, c: Vector, reflection: bool
) -> tuple[float, float, float]:
    """Write ``V diag(1, 1, d) U^T`` of ``(a b c) = U S V^T``, d = det(V U^T); return S, with d.

    The columns are turned in pairs until they are orthogonal (one-sided Jacobi, Hestenes), which
    keeps small singular values exact to their last digits. The third axes are the cross products
    of the others, so that planes, whose last singular value is 0, are not a special case. A mirror
    image that fits better by no more than rounding is not chosen.
    """
    p, q, r = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    floor = ROUNDING * ROUNDING * (_dot(a, a) + _dot(b, b) + _dot(c, c))
    for _ in range(SWEEPS):
        a, b, p, q, turned_ab = _orthogonal(a, b, p, q, floor)
        a, c, p, r, turned_ac = _orthogonal(a, c, p, r, floor)
        b, c, q, r, turned_bc = _orthogonal(b, c, q, r, floor)
        if not (turned_ab or turned_ac or turned_bc):
            break
    if _dot(b, b) > _dot(a, a):
        a, b, p, q = b, a, q, p
    if _dot(c, c) > _dot(a, a):
        a, c, p, r = c, a, r, p
    if _dot(c, c) > _dot(b, b):
        b, c, q, r = c, b, r, q
    first = math.sqrt(_dot(a, a))
    second = math.sqrt(_dot(b, b))
    if second == 0.0:
        return first, 0.0, 0.0
    u, v = _times(1.0 / first, a), _times(1.0 / second, b)
    w, turned = _cross(u, v), _cross(p, q)
    third = _dot(w, c) if _dot(turned, r) > 0.0 else -_dot(w, c)
    if reflection and third < -1e-12 * first:
        turned, third = _times(-1.0, turned), -third
    for row in range(3):
        for column in range(3):
            rotation[row, column] = (
                p[row] * u[column] + q[row] * v[column] + turned[row] * w[column]
            )
    return first, second, third


@inlined()
def _orthogonal(
    a: Vector, b: Vector, p: Vector, q: Vector, floor: float
) -> tuple[Vector, Vector, Vector, Vector, bool]:
    """Return a and b turned in their plane until orthogonal, p and q with them; and if needed."""
    alpha, beta, gamma = _dot(a, a), _dot(b, b), _dot(a, b)
    if gamma * gamma <= ROUNDING * ROUNDING * alpha * beta or min(alpha, beta) <= floor:
        return a, b, p, q, False
    apart, twice = beta - alpha, 2.0 * gamma
    tangent = twice / (apart + math.copysign(math.sqrt(apart * apart + twice * twice), apart))
    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
    sine = cosine * tangent
    return (
        _sum(cosine, a, -sine, b),
        _sum(sine, a, cosine, b),
        _sum(cosine, p, -sine, q),
        _sum(sine, p, cosine, q),
        True,
    )


@inlined()
def _sum(s: float, a: Vector, t: float, b: Vector) -> Vector:
    return s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]


@inlined()
def _times(s: float, a: Vector) -> Vector:
    return s * a[0], s * a[1], s * a[2]


@inlined()
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined()
def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
