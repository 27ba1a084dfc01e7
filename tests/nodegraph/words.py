"""Nodes that join words, in a module that imports little: keys hold all that it imports."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nodegraph import Across, Refusal, Value, node


@dataclass(frozen=True)
class Word(Value):
    """A text, as long as one that lies in a file of its own, or short."""

    text: str
    letters: NDArray[np.float64]


@dataclass(frozen=True)
class Sketch(Word):
    """A word of which only a stand-in is kept."""


class Pair(NamedTuple):
    word: Word
    sketch: Word


def stand_in(text: str) -> Word:
    return Sketch(f"stand-in of {text}", np.zeros(1))


def word_of(name: str, *parts: object, kind: type[Word] = Word) -> Word:
    """Return a word that depends on all its parts, or sometimes raise an error."""
    digest = hashlib.sha256(repr((name, parts)).encode()).digest()
    if digest[0] < 20 and parts:
        raise Refusal(f"{name} does not take {digest[0]}")
    if digest[0] > 240 and parts:
        raise ValueError(f"{name} cannot take {digest[0]}")
    letters = np.frombuffer(digest, np.uint8).astype(float)
    return kind(digest.hex()[:12], np.resize(letters, 400 if digest[1] % 2 else 3))


def content_of(word: Word | None) -> object:
    return word and (word.text, word.letters.tobytes())


@node("word.make")
def make(*, mark: int = 0) -> Pair:
    return Pair(word_of("make", mark), word_of("sketch", mark, kind=Sketch))


@node("word.join")
def join(first: Word, second: Word | None = None, *, mark: int = 0) -> Word:
    return word_of("join", content_of(first), content_of(second), mark)


@node("word.draw")
def draw(first: Word, second: Word | None = None, *, mark: int = 0) -> Word:
    return word_of("draw", content_of(first), content_of(second), mark, kind=Sketch)


@node("word.all")
def gather(parts: Across[Word], second: Word | None = None, *, mark: int = 0) -> Word:
    there = [(sorted(labels.items()), content_of(word)) for labels, word in parts]
    absent = [(sorted(entry.labels.items()), entry.kind, entry.reason) for entry in parts.absent]
    return word_of("all", there, absent, content_of(second), mark)


NODES = (make, join, draw, gather)
