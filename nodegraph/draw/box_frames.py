"""Frames around boxes whose dotted names have a common prefix."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import takewhile

import networkx as nx

Frame = str
"""The common prefix of the names in a frame: ``clean``, or ``clean.fine`` within it."""

Path = tuple[Frame, ...]
"""The frames around a box, from the outermost."""

Member = tuple[str, str]
"""``box`` or ``frame``, and its name."""


def frames_of(names: Iterable[str]) -> dict[str, Path]:
    """Return the frames around each box.

    The boxes ``clean.despike`` and ``clean.smooth`` stand in the frame ``clean``, and so does
    the box ``clean`` itself, which passes their results on.
    """
    names = tuple(names)
    around = {name: _prefixes(name) for name in names}
    frames = {frame for path in around.values() for frame in path}
    return {name: (*around[name], name) if name in frames else around[name] for name in names}


def short_name(name: str, path: Path) -> str:
    """Return the name of a box without the prefixes of its frames."""
    shown = [name.removeprefix(f"{frame}.") for frame in path if frame != name]
    return min(shown, key=len, default=name)


def last_part(frame: Frame) -> str:
    """Return the name of a frame without the prefixes of outer frames."""
    return frame.rpartition(".")[2]


def outline(paths: Mapping[str, Path]) -> Iterator[tuple[str, str, int]]:
    """Yield the events of a walk through nested frames, each with its depth.

    Events are ``("open", frame)``, ``("box", name)`` and ``("close", frame)``. Boxes come in
    their order, those of one frame together.
    """
    first: dict[str, int] = {}
    for number, (name, path) in enumerate(paths.items()):
        for part in (*path, f" {name}"):
            first.setdefault(part, number)
    opened: Path = ()
    for name in sorted(paths, key=lambda name: [first[it] for it in (*paths[name], f" {name}")]):
        shared = shared_frames(opened, paths[name])
        yield from _closed(opened, shared)
        opened = paths[name]
        for depth in range(shared, len(opened)):
            yield "open", opened[depth], depth
        yield "box", name, len(opened)
    yield from _closed(opened, 0)


def shared_frames(path: Path, other: Path) -> int:
    """Return the number of outer frames that two paths have in common."""
    same = (a == b for a, b in zip(path, other, strict=False))
    return sum(takewhile(bool, same))


def _closed(opened: Path, least: int) -> Iterator[tuple[str, str, int]]:
    for depth in range(len(opened) - 1, least - 1, -1):
        yield "close", opened[depth], depth


def without_cycles(
    paths: Mapping[str, Path], arrows: Iterable[tuple[str, str]]
) -> Mapping[str, Path]:
    """Return the paths without frames that arrows leave and enter again by way of others.

    Such a frame cannot stand both below its sources and above its readers.
    """
    arrows = tuple(dict.fromkeys(arrows))
    pending: list[Frame] = [""]
    while pending:
        frame = pending.pop()
        while cyclic := _cyclic(frame, paths, arrows):
            paths = {
                name: tuple(around for around in path if around not in cyclic)
                for name, path in paths.items()
            }
        pending += dict.fromkeys(
            inside[0] for path in paths.values() if (inside := _inside(frame, path))
        )
    return paths


def member(frame: Frame, name: str, path: Path) -> Member | None:
    """Return the member of a frame that contains a box: an inner frame, or the box itself."""
    if frame and frame not in path:
        return None
    inside = _inside(frame, path)
    return ("frame", inside[0]) if inside else ("box", name)


def _prefixes(name: str) -> Path:
    parts = name.split(".")
    if not all(parts):
        return ()
    return tuple(".".join(parts[:count]) for count in range(1, len(parts)))


def _inside(frame: Frame, path: Path) -> Path:
    if not frame:
        return path
    return path[path.index(frame) + 1 :] if frame in path else ()


def _cyclic(
    frame: Frame, paths: Mapping[str, Path], arrows: Sequence[tuple[str, str]]
) -> set[Frame]:
    """Return the frames directly within a frame that lie on a cycle."""
    members = {name: member(frame, name, path) for name, path in paths.items()}
    links = ((members[source], members[target]) for source, target in arrows)
    network: nx.DiGraph[Member] = nx.DiGraph()
    network.add_edges_from(
        (source, target) for source, target in links if source and target and source != target
    )
    return {
        name
        for component in nx.strongly_connected_components(network)
        if len(component) > 1
        for kind, name in component
        if kind == "frame"
    }
