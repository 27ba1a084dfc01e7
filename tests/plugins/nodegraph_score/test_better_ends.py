from __future__ import annotations

from importlib import import_module

import pytest


@pytest.mark.parametrize(
    "name", ["distance", "gaps", "impulses", "roughness", "smoothness", "tracking"]
)
def test_every_declared_end_is_that_of_a_column(name: str) -> None:
    module = import_module(f"nodegraph_score.{name}")
    assert set(module.BETTER) <= set(module.UNITS)
    assert set(module.BETTER.values()) <= {"lower", "higher", "none"}
