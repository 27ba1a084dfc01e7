"""BibTeX keys -> the entries that plugins ship, and what a reader sees of them."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from typing import Any


def references(bibtex: Iterable[str], keys: Iterable[str]) -> Mapping[str, str]:
    """Return the text of each entry; a key that no plugin ships stands for itself.

    Parameters
    ----------
    bibtex
        The BibTeX of each plugin. Where two have an entry of one key, the first counts; one that
        cannot be read is left out with a warning.
    keys
        The entries wanted.
    """
    from pybtex import format_from_string
    from pybtex.database import BibliographyData

    entries = _entries(bibtex)
    wanted = list(dict.fromkeys(keys))
    found = [key for key in wanted if key in entries]
    texts: list[str] = []
    if found:
        source = BibliographyData({key: entries[key] for key in found}).to_string("bibtex")
        text = format_from_string(source, "unsrt", citations=found, output_backend="plaintext")
        texts = [line.partition("] ")[2] for line in text.splitlines() if line.startswith("[")]
    missing = {key: f"{key} (no BibTeX entry is installed)" for key in wanted}
    return missing | dict(zip(found, texts, strict=True))


def entry_keys(bibtex: Iterable[str]) -> tuple[str, ...]:
    """Return the keys of all entries; BibTeX that cannot be read is left out with a warning."""
    return tuple(_entries(bibtex))


def bibtex_of(bibtex: Iterable[str], keys: Iterable[str]) -> str:
    """Return the BibTeX of the entries wanted, sorted by key; one that nobody ships is left out.

    Parameters
    ----------
    bibtex, keys
        As for `references`.
    """
    from pybtex.database import BibliographyData

    entries = _entries(bibtex)
    found = {key: entries[key] for key in sorted(set(keys)) if key in entries}
    return str(BibliographyData(found).to_string("bibtex")) if found else ""


def _entries(bibtex: Iterable[str]) -> dict[str, Any]:
    from pybtex.database import parse_string
    from pybtex.exceptions import PybtexError

    entries: dict[str, Any] = {}
    for text in bibtex:
        try:
            found = parse_string(text, "bibtex").entries
        except PybtexError as error:
            warnings.warn(f"BibTeX of a plugin cannot be read: {error}", stacklevel=3)
            continue
        entries = {**found, **entries}
    return entries
