"""Texts of which some words are more than their letters, such as the names of methods."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from markupsafe import Markup, escape

from nodegraph import Value


@dataclass(frozen=True)
class Word(Value):
    """A part of a text that is more than its letters.

    Attributes
    ----------
    text : str
    kind : {"strong", "suspect", "method", "number"}
        What stands out, what is doubted, what is compared, and what was measured, which is no
        conclusion.
    method : str
        The label of a method that stands out, or whose text says more.
    does : str
        What the method does, in a sentence.
    """

    text: str
    kind: Literal["strong", "suspect", "method", "number"] = "strong"
    method: str = ""
    does: str = ""

    @property
    def label(self) -> str:
        """The label of the method that it names; empty where it names none."""
        return self.text if self.kind == "method" and not self.method else self.method


Text = tuple[str | Word, ...]

HERE = "\N{OBJECT REPLACEMENT CHARACTER}"
"""Stands in a sentence where a part of it comes; see `say`."""


def say(sentence: str, *parts: str | Word | Text) -> Text:
    """Return a sentence with its parts, in their order, in the places of `HERE`."""
    pieces = sentence.split(HERE, len(parts))
    return joined("", itertools.chain.from_iterable(zip(pieces, (*parts, ""), strict=False)))


def joined(separator: str, texts: Iterable[str | Word | Text]) -> Text:
    """Return texts, those that are not empty, one after the other."""
    result: list[str | Word] = []
    for text in texts:
        parts = [part for part in (text if isinstance(text, tuple) else (text,)) if part]
        if parts and result and separator:
            result.append(separator)
        result += parts
    merged: list[str | Word] = []
    for part in result:
        if isinstance(part, str) and merged and isinstance(merged[-1], str):
            merged[-1] += part
        else:
            merged.append(part)
    return tuple(merged)


def listing(texts: Sequence[str | Word | Text], word: str = "and") -> Text:
    """Return texts as a list: ``a, b and c``."""
    return joined(f" {word} ", [joined(", ", texts[:-1]), *texts[-1:]])


def few(texts: Sequence[str | Word | Text], most: int) -> Text:
    """Return the first of several: ``a, b, c and 4 more``."""
    more = len(texts) - most
    return joined("", [joined(", ", texts[:most]), f" and {more} more" if more > 0 else ""])


def plain(text: Text) -> str:
    """Return the letters of a text."""
    return "".join(part if isinstance(part, str) else part.text for part in text)


def html_of(text: Text) -> Markup:
    """Return a text as HTML."""
    return Markup("").join(map(_part_html, text))


def _part_html(part: str | Word) -> Markup:
    if isinstance(part, str):
        return escape(part)
    if part.kind == "number":
        return Markup(f'<span class="lead-number">{escape(part.text)}</span>')
    tag = "span" if part.kind == "method" else "strong"
    method = of_method(part.label, part.does) if part.label else ""
    suspect = ' class="suspect"' if part.kind == "suspect" else ""
    return Markup(f"<{tag}{method}{suspect}>{escape(part.text)}</{tag}>")


def of_method(label: str, does: str) -> str:
    """Return the attributes of an element that names a method."""
    return f' data-method="{escape(label)}"' + (f' title="{escape(does)}"' if does else "")
