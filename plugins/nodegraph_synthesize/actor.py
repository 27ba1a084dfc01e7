"""Actors: proportions, muscle strengths and habits, drawn from a seed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import Head, MarkerSet
from nodegraph_mocap.random_numbers import random_for
from nodegraph_synthesize.activation import Habits, draw_habits
from nodegraph_synthesize.anatomy import Anatomy, draw_strengths, make_anatomy
from nodegraph_synthesize.layout import edges_between, make_layout
from nodegraph_synthesize.muscles import CHANNELS
from nodegraph_synthesize.proportions import Proportions, draw_proportions
from nodegraph_synthesize.surface import Surface, make_surface

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray


@dataclass(frozen=True)
class Actor:
    """Properties of an actor.

    Attributes
    ----------
    proportions : Proportions
    strengths : mapping of channel to float
    habits : Habits
    """

    proportions: Proportions
    strengths: Mapping[str, float]
    habits: Habits

    def anatomy(self, points: NDArray[np.float64]) -> Anatomy:
        """Return the anatomy that moves (N, 3) points of the neutral face."""
        return make_anatomy(points, self.proportions, self.strengths)

    @cached_property
    def surface(self) -> Surface:
        """The neutral face."""
        return make_surface(self.proportions)

    @cached_property
    def morphs(self) -> NDArray[np.float64]:
        """(K, V, 3) mm by which each channel moves the surface's vertices."""
        return self.anatomy(self.surface.vertices).offsets(np.eye(len(CHANNELS)))


@lru_cache(maxsize=8)  # a study has the same actors perform in several ways
def draw_actor(seed: int) -> Actor:
    """Return the actor of a seed."""
    return Actor(
        draw_proportions(random_for("proportions", seed)),
        draw_strengths(random_for("strengths", seed)),
        draw_habits(random_for("habits", seed)),
    )


def head_of(actor: Actor, markers: int) -> tuple[Head, MarkerSet]:
    """Return the actor's head with a number of markers, and their layout."""
    surface = actor.surface
    layout = make_layout(markers, surface.places)
    head = Head(
        vertices=surface.vertices.copy(),
        faces=surface.faces.copy(),
        morphs=actor.morphs.copy(),
        names=CHANNELS,
        markers=layout.marker_set.markers,
        marker_vertices=layout.vertices,
    )
    return head, edges_between(layout.marker_set, surface.vertices[layout.vertices])
