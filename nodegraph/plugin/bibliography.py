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
    from pybtex.backends.plaintext import Backend

    entries = _entries(bibtex)
    wanted = list(dict.fromkeys(keys))
    known = [key for key in wanted if key in entries]
    formatted = _style().format_entries([entries[key] for key in known]) if known else ()
    texts = [each.text.render(Backend()) for each in formatted]
    missing = {key: f"{key} (no BibTeX entry is installed)" for key in wanted}
    return missing | dict(zip(known, texts, strict=True))


def entry_keys(bibtex: Iterable[str]) -> tuple[str, ...]:
    """Return the keys of all entries; text that cannot be parsed is left out with a warning."""
    return tuple(_entries(bibtex))


def bibtex_of(bibtex: Iterable[str], keys: Iterable[str]) -> str:
    """Return the BibTeX of those keys that have an entry, sorted by key.

    Parameters
    ----------
    bibtex, keys
        As for `references`.
    """
    from pybtex.database import BibliographyData
    from pybtex.database.output.bibtex import Writer

    entries = _entries(bibtex)
    known = {key: entries[key] for key in sorted(set(keys)) if key in entries}
    return str(Writer().to_string(BibliographyData(known))) if known else ""


def _entries(bibtex: Iterable[str]) -> dict[str, Entry]:
    from pybtex.exceptions import PybtexError

    entries: dict[str, Entry] = {}
    for text in bibtex:
        try:
            parsed = _parsed(text)
        except PybtexError as error:
            warnings.warn(f"BibTeX of a plugin cannot be read: {error}", stacklevel=3)
            continue
        entries = {**parsed, **entries}
    return entries


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
