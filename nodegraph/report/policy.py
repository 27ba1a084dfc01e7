"""The page's Content Security Policy: no network, and no script but those that are known."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable
from html.parser import HTMLParser


def policy(fragments: Iterable[str], *own: str) -> str:
    """Return the policy of a page.

    Parameters
    ----------
    fragments : iterable of str
        Trusted HTML: the scripts in it may run, by their hashes.
    own : str
        The page's own scripts.
    """
    scripts = dict.fromkeys([*own, *(one for html in fragments for one in _scripts(html))])
    allowed = " ".join(f"'sha256-{_digest(one)}'" for one in scripts)
    rules = ["default-src 'none'", f"script-src {allowed}", "style-src 'unsafe-inline'"]
    rules += ["img-src data: blob:", "media-src data: blob:", "font-src data:"]
    rules += ["base-uri 'none'", "form-action 'none'"]
    return "; ".join(rules)


def _digest(script: str) -> str:
    same_line_ends = script.replace("\r\n", "\n").replace("\r", "\n")
    return base64.b64encode(hashlib.sha256(same_line_ends.encode()).digest()).decode()


def _scripts(html: str) -> list[str]:
    if "<script" not in html.lower():
        return []
    reader = _ScriptReader()
    reader.feed(html)
    reader.close()
    return reader.scripts


class _ScriptReader(HTMLParser):
    """Collects what stands in script elements."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=False)
        self.scripts: list[str] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag == "script"
        if self._inside:
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        self._inside = False

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.scripts[-1] += data
