"""Frames around boxes whose dotted names have a common prefix."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import count

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


def nested(
    names: Iterable[str],
    begin: Callable[[int, str], Iterable[str]],
    end: str,
    box: Callable[[str, str], str],
) -> Iterator[str]:
    """Return the lines of boxes, in their order but those of one frame together, and indented.

    Parameters
    ----------
    names
    begin
        Returns the lines with which a frame of some number and name begins.
    end
        The line with which a frame ends.
    box
        Returns the line of a box of some name, which has another in its frame.
    """
    frames = frames_of(names)
    numbers = count()

    def lines(frame: Frame) -> Iterator[str]:
        opened: set[Frame] = set()
        for name, path in frames.items():
            inner = path[: len(frame) + 1]
            if path == frame:
                yield f"  {box(name, label_of(name, frame))}"
            elif path[: len(frame)] == frame and inner not in opened:
                opened.add(inner)
                within = (*begin(next(numbers), inner[-1]), *lines(inner), end)
                yield from (f"  {line}" for line in within)

    return lines(())
