"""Any text, for Hypothesis."""

from __future__ import annotations

from functools import partial

from hypothesis import strategies as st

any_text = partial(st.text, st.characters(exclude_categories=["Cs"]))
"""`st.text` of all characters; its own alphabet, the same, takes seconds to be found in a codec."""
