"""BibTeX of plugins: keys, formatted references, and the source of chosen entries."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping


def references(bibtex: Iterable[str], keys: Iterable[str]) -> Mapping[str, str]:
    """Return the formatted entry of each key; a key without an entry is its own text.

    Parameters
    ----------
    bibtex
        The BibTeX of each plugin. If two have an entry of the same key, the first counts; text
        that cannot be parsed is left out with a warning.
    keys
    """
    from pybtex import format_from_string
    from pybtex.database import BibliographyData

    entries = _entries(bibtex)
    wanted = list(dict.fromkeys(keys))
    known = [key for key in wanted if key in entries]
    texts: list[str] = []
    if known:
        source = BibliographyData({key: entries[key] for key in known}).to_string("bibtex")
        text = format_from_string(source, "unsrt", citations=known, output_backend="plaintext")
        texts = [line.partition("] ")[2] for line in text.splitlines() if line.startswith("[")]
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

    entries = _entries(bibtex)
    known = {key: entries[key] for key in sorted(set(keys)) if key in entries}
    return str(BibliographyData(known).to_string("bibtex")) if known else ""


def _entries(bibtex: Iterable[str]) -> dict[str, object]:
    # not parse_string, which looks through all installed packages for a parser each time
    from pybtex.database.input.bibtex import Parser
    from pybtex.exceptions import PybtexError

    entries: dict[str, object] = {}
    for text in bibtex:
        try:
            parsed = Parser().parse_string(text).entries
        except PybtexError as error:
            warnings.warn(f"BibTeX of a plugin cannot be read: {error}", stacklevel=3)
            continue
        entries = {**parsed, **entries}
    return entries
