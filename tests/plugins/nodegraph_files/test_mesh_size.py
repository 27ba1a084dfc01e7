from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from nodegraph_files.head import unit_of_mesh

PATH = Path("head.glb")


@pytest.mark.parametrize("assumed", ["m", "mm"])
@pytest.mark.parametrize("stated", [True, False])
def test_a_plausible_size_says_nothing(assumed: str, stated: bool) -> None:
    extent = {"m": 0.24, "mm": 240.0}[assumed]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert unit_of_mesh(PATH, extent, assumed=assumed, stated=stated) == assumed


@pytest.mark.parametrize(
    ("extent", "assumed", "unit"),
    [(240.0, "m", "mm"), (24.0, "m", "cm"), (0.24, "mm", "m"), (24.0, "mm", "cm")],
)
def test_another_unit_is_taken_where_it_alone_is_plausible(
    extent: float, assumed: str, unit: str
) -> None:
    with pytest.warns(UserWarning, match=rf"head\.glb: the head would be .*; {unit} is taken, giv"):
        assert unit_of_mesh(PATH, extent, assumed=assumed, stated=False) == unit


@pytest.mark.parametrize("extent", [1.8, 0.02, 0.0])
def test_an_implausible_size_is_reported_and_the_unit_stays(extent: float) -> None:
    with pytest.warns(UserWarning, match="long in m, which no head is; set `unit`"):
        assert unit_of_mesh(PATH, extent, assumed="m", stated=False) == "m"


def test_a_stated_unit_is_not_doubted_but_told() -> None:
    with pytest.warns(UserWarning, match=r"the mesh is 2\.4e\+05 mm long in m, which no head is"):
        assert unit_of_mesh(PATH, 240.0, assumed="m", stated=True) == "m"
