"""Recordings that are of one actor, which are one unit: as the graph says, or as they look."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from nodegraph import Value, listed
from nodegraph_tables import difference, info_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from nodegraph import Across, Label
    from nodegraph_mocap import Table
    from nodegraph_tables import Poses

ACTOR = "actor"
"""The axis, or the field of an axis, that says who is recorded."""
_NEAR = 1.0
"""mm, within which takes of one person come to each other's neutral; see `difference`."""
_MOST = 300
"""Recordings that are held against one another; further ones are not."""

Combination = tuple["Label", ...]


@dataclass(frozen=True)
class Alike(Value):
    """Recordings that are not independent of each other, though the graph does not say so.

    Attributes
    ----------
    recordings : tuple of (tuple of combination)
        Labels of the axes of sources: sets of recordings that are the same.
    clusters : tuple of (tuple of combination)
        Labels of the clusters: sets that count as one, since their recordings are the same or look
        like one person's.
    warning : str
        Which, and what to write; empty where there are none.
    """

    recordings: tuple[tuple[Combination, ...], ...] = ()
    clusters: tuple[tuple[Combination, ...], ...] = ()
    warning: str = ""


def clusters_of(scores: Across[Table], sources: tuple[str, ...]) -> tuple[str, ...]:
    """Return what the clusters are unless a setting says so.

    The axis `actor`, or the field `actor` of an axis, where the data differ along it; else every
    axis along which they do.
    """
    if ACTOR in sources:
        return (ACTOR,)
    fields = [f"{axis}.{ACTOR}" for axis in sources]
    return tuple(name for name in fields if name in scores.fields) or sources


def find_alike(scores: Across[Table], clusters: tuple[str, ...], sources: tuple[str, ...]) -> Alike:
    """Return which recordings in different clusters are the same, or look like one person's.

    Those that look like one person's count as one cluster, unless the clusters are actors by name,
    or by a field: then the graph says who is who.
    """
    if not all(name in scores.axes or name in scores.fields for name in clusters):
        return Alike()
    poses: dict[Combination, Poses] = {}
    owner: dict[Combination, Combination] = {}
    for labels, table in scores:
        known = info_of(table).poses
        recording = tuple(labels.get(axis, "") for axis in sources)
        if known is None or not known.positions:
            continue
        if len(poses) < _MOST and recording not in poses:
            poses[recording] = known
            owner[recording] = tuple(label_at(scores, name, labels) for name in clusters)
    same: list[tuple[Combination, Combination]] = []
    near: list[tuple[Combination, Combination]] = []
    for first, second in combinations(poses, 2):
        if owner[first] == owner[second]:
            continue
        if poses[first] == poses[second]:
            same.append((first, second))
        elif difference(poses[first], poses[second]) <= _NEAR:
            near.append((first, second))
    said = any("." in name or name == ACTOR for name in clusters)
    counted = same if said else same + near
    joined = [(owner[first], owner[second]) for first, second in counted]
    sets = _joined(poses, same)
    texts = [_same_text(sets), _near_text(_joined(poses, near), said, sources)]
    clusters_alike = _joined(dict.fromkeys(owner.values()), joined)
    return Alike(sets, clusters_alike, " ".join(filter(None, texts)))


def label_at(scores: Across[Table], name: str, labels: Mapping[str, Label]) -> Label:
    """Return the label of an axis, or the field of that label, in one place."""
    if name in scores.axes:
        return labels.get(name, "")
    return scores.fields[name].get(labels.get(name.partition(".")[0], ""), "")


def _joined(
    order: Iterable[Combination], pairs: Sequence[tuple[Combination, Combination]]
) -> tuple[tuple[Combination, ...], ...]:
    """Return the sets into which pairs join, each in an order that is given."""
    import networkx as nx

    network: nx.Graph[Combination] = nx.Graph(pairs)
    place = {node: index for index, node in enumerate(order)}
    parts = (sorted(part, key=place.__getitem__) for part in nx.connected_components(network))
    return tuple(map(tuple, parts))


def _named(parts: Sequence[tuple[Combination, ...]]) -> str:
    return "; ".join(listed([", ".join(map(str, labels)) for labels in part]) for part in parts)


def _same_text(same: Sequence[tuple[Combination, ...]]) -> str:
    if not same:
        return ""
    return f"the same recording stands behind {_named(same)}: it is counted once."


def _near_text(
    near: Sequence[tuple[Combination, ...]], said: bool, sources: tuple[str, ...]
) -> str:
    if not near:
        return ""
    found = (
        f"{_named(near)} look like takes of one person: the same markers, which come within "
        f"{_NEAR:g} mm of each other's places"
    )
    if said:
        return f"{found}; they are counted as different actors, as the graph says."
    return (
        f"{found}; they are counted as one. Say who is recorded: --axis '{sources[0]}={{files: "
        '"data/{actor}_{take}.c3d"}\', or {label: {file: ..., actor: ...}}.'
    )
