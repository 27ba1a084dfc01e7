"""BibTeX keys -> the entries that plugins ship, and what a reader sees of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from nodegraph.errors import NodegraphError


def references(bibtex: str, keys: Iterable[str]) -> Mapping[str, str]:
    """Return the text of each entry; a key that no plugin ships stands for itself.

    Raises
    ------
    NodegraphError
        If the BibTeX that plugins ship cannot be read.
    """
    from pybtex import format_from_string
    from pybtex.database import parse_string
    from pybtex.exceptions import PybtexError

    wanted = list(dict.fromkeys(keys))
    try:
        there = parse_string(bibtex, "bibtex").entries
        found = [key for key in wanted if key in there]
        text = (
            format_from_string(bibtex, "unsrt", citations=found, output_backend="plaintext")
            if found
            else ""
        )
    except PybtexError as error:
        raise NodegraphError(f"the BibTeX of the plugins cannot be read: {error}") from error
    lines = [line.partition("] ")[2] for line in text.splitlines() if line.startswith("[")]
    missing = {key: f"{key} (no BibTeX entry is installed)" for key in wanted}
    return missing | dict(zip(found, lines, strict=True))
