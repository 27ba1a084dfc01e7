"""A page of the site, and what the search knows of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


class Entry(NamedTuple):
    """Something that the search finds: its name, a sentence on it, its place on the page."""

    name: str
    text: str
    anchor: str = ""


@dataclass(frozen=True)
class Page:
    """A page of the site.

    Attributes
    ----------
    path : str
        From the site's folder: ``nodes/fill.html``.
    title : str
    body : str
        HTML in which all text from users is escaped.
    entries : tuple of Entry
    """

    path: str
    title: str
    body: str
    entries: tuple[Entry, ...] = ()
