"""Any text, for Hypothesis, and texts of files."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from hypothesis import strategies as st

any_text = partial(st.text, st.characters(exclude_categories=["Cs"]))
"""`st.text` of all characters; its own alphabet, the same, takes seconds to be found in a codec."""


def edit(file: str | Path, old: str, new: str) -> None:
    """Change a file wherever a text stands in it."""
    path = Path(file)
    text = path.read_text()
    assert old in text, f"{file} has no {old!r}"
    path.write_text(text.replace(old, new))
