"""Imports go down only, plugins use the public face, and the machine knows no method."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import nodegraph

ROOT = Path(__file__).parents[1]
FLOORS = (  # from the top
    {"cli"},
    {"archive", "audit", "notebook"},
    {"lock", "report"},
    {"api", "runs", "testing"},
    {"execute"},
    {"fingerprint"},
    {"draw", "plan"},
    {"graph"},
    {"graphfile", "store"},
    {"plugin"},
    {"node"},
    {"equality", "errors", "formatting", "gc_pause", "import_time", "validation"},
)
FLOOR = {unit: number for number, floor in enumerate(FLOORS) for unit in floor}
MACHINE = sorted((ROOT / "nodegraph").rglob("*.py"))
PLUGINS = sorted((ROOT / "plugins").glob("nodegraph_*/**/*.py"))
NOT_OURS = {
    "face", "faces", "facial", "recording", "recordings", "marker", "markers", "trajectory",
    "trajectories", "mocap", "blendshape", "blendshapes", "landmark", "landmarks", "skeleton",
    "neutral", "procrustes",
}  # fmt: skip
SHARED = {"nodegraph_mocap", "nodegraph_tables", "nodegraph_files"}
"""Packages of types and helpers that other plugins may import."""
PLUGGYS = {"HookspecMarker", "HookimplMarker"}


def imports(path: Path) -> Iterator[tuple[str, str]]:
    """Yield every imported module with each name taken from it, empty for the module itself."""
    for found in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(found, ast.Import):
            yield from ((alias.name, "") for alias in found.names)
        elif isinstance(found, ast.ImportFrom):
            assert found.level == 0, f"{path}:{found.lineno} is a relative import"
            yield from ((found.module or "", alias.name) for alias in found.names)


def unit_of(path: Path) -> str:
    parts = path.relative_to(ROOT / "nodegraph").with_suffix("").parts
    return parts[0]


def test_every_part_of_the_machine_has_a_floor() -> None:
    assert {unit_of(path) for path in MACHINE} == {*FLOOR, "__init__"}


@pytest.mark.parametrize("path", MACHINE, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_go_down_only(path: Path) -> None:
    here = unit_of(path)
    for module, name in imports(path):
        package, *parts = module.split(".")
        assert not package.startswith("nodegraph_"), f"{path} knows the plugin {package}"
        if package == "nodegraph" and here != "__init__":
            there = parts[0] if parts else name
            assert there == here or FLOOR[there] > FLOOR[here], f"{here} imports {there}"


@pytest.mark.parametrize("path", PLUGINS, ids=lambda path: str(path.relative_to(ROOT)))
def test_plugins_import_public_names_only_and_never_each_other(path: Path) -> None:
    here = path.relative_to(ROOT / "plugins").parts[0]
    for module, name in imports(path):
        package = module.partition(".")[0]
        if package == "nodegraph":
            assert module == "nodegraph", f"{path} imports {module}"
            assert name in nodegraph.__all__, f"{path} imports {name}"
        elif package.startswith("nodegraph_"):
            assert package in (here, *SHARED), f"{path} imports {module}"


@pytest.mark.parametrize("path", MACHINE, ids=lambda path: str(path.relative_to(ROOT)))
def test_the_machine_has_no_word_of_motion_capture(path: Path) -> None:
    for name in set(identifiers(path)) - PLUGGYS:
        words = {word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+", name)}
        assert not words & NOT_OURS, f"{path} names something {name!r}"


def identifiers(path: Path) -> Iterator[str]:
    for found in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(found, ast.Name):
            yield found.id
        elif isinstance(found, ast.Attribute):
            yield found.attr
        elif isinstance(found, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            yield found.name
        elif isinstance(found, (ast.arg, ast.keyword)):
            yield found.arg or ""
