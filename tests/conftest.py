"""No test finds what another has stored, and none writes where a user's results lie."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest


@pytest.fixture(scope="session", autouse=True)
def _not_the_users_store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep fixtures that live longer than a test from the user's store, too."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("NODEGRAPH_STORE", str(tmp_path_factory.mktemp("store")))
        yield


@pytest.fixture(autouse=True)
def store_folder(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give every test a store of its own."""
    folder = tmp_path_factory.mktemp("store")
    monkeypatch.setenv("NODEGRAPH_STORE", str(folder))
    return folder
