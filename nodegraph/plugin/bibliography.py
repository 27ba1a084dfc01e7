"""BibTeX of plugins: keys, formatted references, and the source of chosen entries."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pybtex.database import Entry
    from pybtex.style.formatting import BaseStyle


def references(bibtex: Iterable[str], keys: Iterable[str]) -> Mapping[str, str]:
    """Return the formatted entry of each key; a key without an entry is its own text.

    Parameters
    ----------
    bibtex
        The BibTeX of each plugin. If two have an entry of the same key, the first counts; text
        that cannot be parsed is left out with a warning.
    keys
    """
    sources = _sources(bibtex)
    return {
        key: _formatted(sources[key], key)
        if key in sources
        else f"{key} (no BibTeX entry is installed)"
        for key in keys
    }


def entry_keys(bibtex: Iterable[str]) -> tuple[str, ...]:
    """Return the keys of all entries; text that cannot be parsed is left out with a warning."""
    return tuple(_sources(bibtex))


def bibtex_of(bibtex: Iterable[str], keys: Iterable[str]) -> str:
    """Return the BibTeX of those keys that have an entry, sorted by key.

    Parameters
    ----------
    bibtex, keys
        As for `references`.
    """
    from pybtex.database import BibliographyData
    from pybtex.database.output.bibtex import Writer

    sources = _sources(bibtex)
    known = {key: _parsed(sources[key])[key] for key in sorted(set(keys)) if key in sources}
    return str(Writer().to_string(BibliographyData(known))) if known else ""


def _sources(bibtex: Iterable[str]) -> dict[str, str]:
    """Return the text that has the entry of each key."""
    from pybtex.exceptions import PybtexError

    sources: dict[str, str] = {}
    for text in bibtex:
        try:
            parsed = _parsed(text)
        except PybtexError as error:
            warnings.warn(f"BibTeX of a plugin cannot be read: {error}", stacklevel=3)
            continue
        sources = {**dict.fromkeys(parsed, text), **sources}
    return sources


@cache
def _formatted(bibtex: str, key: str) -> str:
    from pybtex.backends.plaintext import Backend

    (entry,) = _style().format_entries([_parsed(bibtex)[key]])
    return str(entry.text.render(Backend()))


# by their classes: for a name, pybtex looks through all installed packages each time


@cache
def _parsed(text: str) -> dict[str, Entry]:
    from pybtex.database.input.bibtex import Parser

    return dict(Parser().parse_string(text).entries)


@cache
def _style() -> BaseStyle:
    from pybtex.style.formatting.unsrt import Style
    from pybtex.style.labels.number import LabelStyle
    from pybtex.style.names.plain import NameStyle
    from pybtex.style.sorting.none import SortingStyle

    return Style(label_style=LabelStyle, name_style=NameStyle, sorting_style=SortingStyle)
