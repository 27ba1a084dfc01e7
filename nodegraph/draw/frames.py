"""Frames around boxes whose dotted names have a common prefix."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

Frame = tuple[str, ...]
"""The words of the names in a frame that are equal: ``("clean", "fine")``."""


def frames_of(names: Iterable[str]) -> dict[str, Frame]:
    """Return the innermost frame around each box.

    The boxes ``clean.despike`` and ``clean.smooth`` stand in the frame ``clean``, and so does
    the box ``clean`` itself, which passes their results on.
    """
    words = {name: tuple(name.split(".")) if ".." not in f".{name}." else (name,) for name in names}
    frames = {path[:depth] for path in words.values() for depth in range(1, len(path))}
    return {name: path if path in frames else path[:-1] for name, path in words.items()}


def label_of(name: str, frame: Frame) -> str:
    """Return the name of a box without that of the frame around it."""
    words = name.split(".")
    return (".".join(words[len(frame) :]) or words[-1]) if frame else name


def outline(frames: Mapping[str, Frame], frame: Frame = ()) -> Iterator[tuple[str, str, int]]:
    """Yield the events of a walk through nested frames, each with its depth.

    Events are ``("open", label)``, ``("box", name)`` and ``("close", label)``. Boxes come in
    their order, those of one frame together.
    """
    depth = len(frame)
    opened: set[Frame] = set()
    for name, path in frames.items():
        inner = path[: depth + 1]
        if path == frame:
            yield "box", name, depth
        elif path[:depth] == frame and inner not in opened:
            opened.add(inner)
            yield "open", inner[-1], depth
            yield from outline(frames, inner)
            yield "close", inner[-1], depth
