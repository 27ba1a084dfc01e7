"""Matching the weights of one face to the shapes of another."""

from __future__ import annotations

import warnings
from collections.abc import Mapping

from nodegraph import listed
from nodegraph_mocap import Weights
from nodegraph_mocap.shape_names import matched


def shapes_of(weights: Weights, names: tuple[str, ...], face: str) -> Mapping[str, str]:
    """Return the shape that each weight drives; warn of weights and shapes that are left over.

    Parameters
    ----------
    weights
    names
        Of the shapes.
    face
        What has the shapes, for messages: ``model`` or ``head``.

    Raises
    ------
    ValueError
        If no weight has a shape, or one could have two.
    """
    matches = matched(weights.names, names)
    if not matches:
        raise ValueError(
            f"weights and {face} have no shape in common: the weights have "
            f"{listed(weights.names)}, the {face} {listed(names)}"
        )
    spare = [name for name in weights.names if name not in matches]
    driven = set(matches.values())
    still = [name for name in names if name not in driven]
    if spare:
        warnings.warn(
            f"{len(spare)} of {len(weights.names)} weights have no shape on the {face}, and are "
            f"left out: {listed(spare)}",
            stacklevel=3,
        )
    if still:
        warnings.warn(
            f"{len(still)} of the {face}'s {len(names)} shapes have no weight, and stay at 0: "
            f"{listed(still)}",
            stacklevel=3,
        )
    return matches
