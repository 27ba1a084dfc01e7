"""Comparisons of which nobody sees the picture."""

from __future__ import annotations

import pytest
from matplotlib.figure import Figure


@pytest.fixture
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw nothing, which would take most of the time."""
    for part in ("table", "ranks", "curve"):
        monkeypatch.setattr(f"nodegraph_compare.{part}.figure.draw", lambda *given: Figure())
