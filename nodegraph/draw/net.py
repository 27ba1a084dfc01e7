"""Boxes in layers, and the bends by which long arrows pass the layers between."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from nodegraph.draw.picture import Arrow, Picture
from nodegraph.draw.shape import Shape

BEND_WIDTH = 12.0


@dataclass(frozen=True, slots=True)
class Segment:
    """A piece of an arrow between neighbouring layers; offsets count from the cells' middles."""

    upper: int
    lower: int
    upper_offset: float = 0.0
    lower_offset: float = 0.0
    weight: float = 1.0


@dataclass
class Net:
    """Cells are boxes, numbered as in the picture, then bends.

    Attributes
    ----------
    layers : list of list of int
        The cells of each layer, from the top.
    widths : list of float
    gaps : list of list of Segment
        The segments below each layer.
    chains : list of list of int
        Bends of long arrows, each list from the top.
    routes : list of list of int
        For each arrow its cells: the source, bends, the target.
    """

    layers: list[list[int]]
    widths: list[float]
    gaps: list[list[Segment]]
    chains: list[list[int]] = field(default_factory=list)
    routes: list[list[int]] = field(default_factory=list)

    def bend(self, layer: int) -> int:
        """Add a bend to a layer and return its number."""
        self.widths.append(BEND_WIDTH)
        self.layers[layer].append(len(self.widths) - 1)
        return len(self.widths) - 1


def net(picture: Picture, shapes: Sequence[Shape]) -> Net:
    """Return the picture's boxes in layers; arrows that leave one port share their bends."""
    numbers = {box.name: index for index, box in enumerate(picture.boxes)}
    depths = depths_of(list(numbers), picture.arrows)
    count = max(depths.values(), default=-1) + 1
    made = Net(
        [[] for _ in range(count)], [one.width for one in shapes], [[] for _ in range(count)]
    )
    for name, number in numbers.items():
        made.layers[depths[name]].append(number)
    chains: dict[tuple[str, str, bool], list[int]] = {}
    for arrow in picture.arrows:
        source, target = numbers[arrow.source], numbers[arrow.target]
        first, last = depths[arrow.source], depths[arrow.target]
        chain = chains.setdefault((arrow.source, arrow.source_port, arrow.truth), [source])
        begins = shapes[source].outputs[arrow.source_port] - shapes[source].width / 2
        for layer in range(first + len(chain), last):
            chain.append(made.bend(layer))
            made.gaps[layer - 1].append(_inner_segment(chain, begins))
        route = [*chain[: last - first], target]
        ends = shapes[target].inputs[arrow.target_port] - shapes[target].width / 2
        offset = begins if len(route) == 2 else 0.0
        weight = 1.0 if len(route) == 2 else 2.0
        made.gaps[last - 1].append(Segment(route[-2], target, offset, ends, weight))
        made.routes.append(route)
    made.chains = [chain[1:] for chain in chains.values() if len(chain) > 1]
    return made


def _inner_segment(chain: Sequence[int], begins: float) -> Segment:
    """Return the segment to a chain's last bend; those between bends are kept straightest."""
    if len(chain) == 2:
        return Segment(chain[0], chain[1], begins, 0.0, 2.0)
    return Segment(chain[-2], chain[-1], 0.0, 0.0, 8.0)


def depths_of(names: Sequence[str], arrows: Sequence[Arrow]) -> dict[str, int]:
    """Return each box's layer: below all that feeds it, and no higher than its readers need.

    Raises
    ------
    ValueError
        If arrows run in a circle.
    """
    above: dict[str, list[str]] = {name: [] for name in names}
    below: dict[str, list[str]] = {name: [] for name in names}
    for arrow in arrows:
        above[arrow.target].append(arrow.source)
        below[arrow.source].append(arrow.target)
    order = _topological(names, above, below)
    depths: dict[str, int] = {}
    for name in order:
        depths[name] = max((depths[one] + 1 for one in above[name]), default=0)
    for name in reversed(order):
        if below[name] and len(below[name]) >= len(above[name]):
            depths[name] = min(depths[one] for one in below[name]) - 1
    return depths


def _topological(
    names: Sequence[str], above: Mapping[str, list[str]], below: Mapping[str, list[str]]
) -> list[str]:
    waiting = {name: len(above[name]) for name in names}
    order = [name for name in names if not waiting[name]]
    for name in order:  # grows while it is read
        for reader in below[name]:
            waiting[reader] -= 1
            if not waiting[reader]:
                order.append(reader)
    if len(order) < len(names):
        circle = ", ".join(name for name in names if waiting[name])
        raise ValueError(f"arrows run in a circle among or into: {circle}")
    return order
