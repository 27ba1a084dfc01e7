"""Matching the weights of one face to the shapes of another."""

from __future__ import annotations

import warnings
from dataclasses import replace

from nodegraph import listed
from nodegraph_mocap import Weights
from nodegraph_mocap.shape_names import matched, sides_as


def driving(weights: Weights, names: tuple[str, ...], face: str) -> tuple[Weights, tuple[str, ...]]:
    """Return the weights that drive a face, and the shape that each of them drives.

    Shapes that only one of the two splits into left and right are split or joined. Warnings say
    which, and which weights and shapes are left over.

    Parameters
    ----------
    weights
    names
        Names of the shapes.
    face
        The object that has the shapes, for messages: ``model`` or ``head``.

    Raises
    ------
    ValueError
        If no weight has a shape, or one could have two.
    """
    sides = sides_as(weights.names, names)
    matches = matched(sides.names, names)
    if not matches:
        raise ValueError(
            f"weights and {face} have no shape in common: the weights have "
            f"{listed(weights.names)}, the {face} {listed(names)}"
        )
    for note in sides.notes:
        warnings.warn(note, stacklevel=3)
    spare = [name for name in sides.names if name not in matches]
    driven = set(matches.values())
    still = [name for name in names if name not in driven]
    if spare:
        warnings.warn(
            f"{len(spare)} of {len(sides.names)} weights have no shape on the {face}, and are "
            f"left out: {listed(spare)}",
            stacklevel=3,
        )
    if still:
        warnings.warn(
            f"{len(still)} of the {face}'s {len(names)} shapes have no weight, and stay at 0: "
            f"{listed(still)}",
            stacklevel=3,
        )
    columns = [sides.names.index(name) for name in matches]
    values = sides.of(weights.values)[:, columns]
    return replace(weights, values=values, names=tuple(matches)), tuple(matches.values())
