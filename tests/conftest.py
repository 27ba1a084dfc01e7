"""No test finds what another has stored, and none writes where a user's results lie."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def store_folder(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give every test a store of its own."""
    folder = tmp_path_factory.mktemp("store")
    monkeypatch.setenv("NODEGRAPH_STORE", str(folder))
    return folder
