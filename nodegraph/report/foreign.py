"""What a page may hold of results that were stored, which may be another person's."""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from dataclasses import replace
from functools import cache
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

from nodegraph.plugin.hook_types import Rendered
from nodegraph.plugin.hooks import GROUP

_ACTIVE = re.compile(
    r'<(?!script type="application/json" )(script|meta|base|link|iframe|frame|object|embed)\b',
    re.IGNORECASE,
)
"""Elements that act as soon as a page is opened; no browser takes another text for one."""


def without_foreign_code(rendered: Rendered) -> Rendered:
    """Return what is shown of a value without code that is of no installed package.

    A script stays if it is, to the letter, a file ``.js`` of an installed package, or a constant
    of a module that is imported, as those of ``--plugin`` are.

    Returns
    -------
    Rendered
        The same object if nothing is left out.
    """
    html, lead = passive(rendered.html), passive(rendered.lead)
    scripts = tuple(filter(_is_own, rendered.scripts))
    if (html, lead, scripts) == (rendered.html, rendered.lead, rendered.scripts):
        return rendered
    return replace(rendered, html=html, lead=lead, scripts=scripts)


def passive(html: str) -> str:
    """Return HTML, or nothing if it holds a script, loads something or leads elsewhere by itself.

    What else could run, such as an attribute ``onclick``, the policy of the page forbids.
    """
    return "" if _ACTIVE.search(html) else html


def _is_own(script: str) -> bool:
    return script in _installed_scripts() or any(
        type(value) is str and value == script
        for module in list(sys.modules.values())
        for value in list(getattr(module, "__dict__", {}).values())
    )


@cache
def _installed_scripts() -> frozenset[str]:
    texts = set()
    for package in {entry.module.partition(".")[0] for entry in entry_points(group=GROUP)}:
        with suppress(ImportError, ValueError):  # a plugin that cannot be imported has none
            spec = find_spec(package)
            for folder in (spec and spec.submodule_search_locations) or ():
                texts |= {path.read_text(encoding="utf-8") for path in Path(folder).rglob("*.js")}
    return frozenset(texts)
