"""Imports go down only, plugins use the public names, and the machine knows no method."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.metadata import packages_distributions, requires
from pathlib import Path

import networkx as nx
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import nodegraph
from nodegraph import executors

ROOT = Path(__file__).parents[1]
FLOORS = (  # from the top
    {"cli"},
    {"api"},
    {"editor"},
    {"archive", "audit", "edit", "notebook", "serve", "site"},
    {"lock", "report"},
    {"built_in", "testing"},
    {"live"},
    {"executors", "runs"},
    {"execute"},
    {"cache_key"},
    {"draw", "plan"},
    {"graph"},
    {"graphfile", "remote", "store"},
    {"plugin"},
    {"node"},
    {
        "equality",
        "errors",
        "filenames",
        "formatting",
        "gc_pause",
        "import_time",
        "kernels",
        "state",
        "supervisor",
        "validation_errors",
        "whole_files",
    },
)
FLOOR = {unit: number for number, floor in enumerate(FLOORS) for unit in floor}
PUBLIC = {"nodegraph": nodegraph.__all__, "nodegraph.executors": executors.__all__}
"""The names that plugins may import, by module."""
SHARED = {"nodegraph_mocap", "nodegraph_tables", "nodegraph_files"}
"""Packages of types and helpers that other plugins may import."""

WORDS_OF_THE_FIELD = {
    "face", "faces", "facial", "recording", "recordings", "marker", "markers", "trajectory",
    "trajectories", "mocap", "blendshape", "blendshapes", "landmark", "landmarks", "skeleton",
    "neutral", "procrustes",
}  # fmt: skip
HEAVY = {
    *("distributed", "matplotlib", "numba", "pandas", "pywt", "rerun", "scipy", "sklearn"),
    "xarray",
}
"""Libraries that nodes import when they are called, so that commands start fast."""

NAMES_OF_PLUGGY = {"HookspecMarker", "HookimplMarker"}


def modules(*folders: Path) -> dict[str, Path]:
    """Return the files of the modules below folders, by the modules' names."""
    return {
        ".".join(path.relative_to(folder.parent).with_suffix("").parts).removesuffix(
            ".__init__"
        ): path
        for folder in folders
        for path in sorted(folder.rglob("*.py"))
        if "templates" not in path.parts
    }


MACHINE = modules(ROOT / "nodegraph")
del MACHINE["nodegraph.site.reference"]  # mkdocs runs it, when the guides are built
PLUGINS = modules(*(path.parent for path in (ROOT / "plugins").glob("nodegraph_*/__init__.py")))


@cache
def imports(path: Path) -> list[tuple[str, str]]:
    """Return every imported module with each name taken from it, empty for the module itself.

    Imports for type checking only, those inside functions and those by a text are included.
    """
    names: list[tuple[str, str]] = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.extend((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno} is a relative import"
            names.extend((node.module or "", alias.name) for alias in node.names)
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            texts = (word.value for word in node.args if isinstance(word, ast.Constant))
            names.extend((text, "") for text in texts if isinstance(text, str))
    return names


def unit_of(module: str) -> str:
    """Return the package or module directly below ``nodegraph`` to which a module belongs."""
    return module.split(".")[1] if "." in module else "__init__"


def test_every_part_of_the_machine_has_a_floor() -> None:
    assert set(map(unit_of, MACHINE)) == {*FLOOR, "__init__"}


def test_imports_go_down_only() -> None:
    wrong = []
    for here, path in MACHINE.items():
        for module, name in imports(path):
            package, *parts = module.split(".")
            if package == "nodegraph" and unit_of(here) != "__init__":
                unit = parts[0] if parts else name
                if unit != unit_of(here) and FLOOR[unit] <= FLOOR[unit_of(here)]:
                    wrong.append(f"{here} imports {module}")
            elif package.startswith("nodegraph_"):
                wrong.append(f"{here} imports the plugin {package}")
    assert not wrong


def test_plugins_import_public_names_only_and_never_each_other() -> None:
    wrong = []
    for here, path in PLUGINS.items():
        for module, name in imports(path):
            package = module.partition(".")[0]
            is_public = name in PUBLIC.get(module, ())
            is_shared = package in (here.partition(".")[0], *SHARED)
            if package.partition("_")[0] == "nodegraph" and not is_public and not is_shared:
                wrong.append(f"{here} imports {name} from {module}")
    assert not wrong


def test_imported_libraries_are_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    users = ("archive", "testing", "dask", "open", "live", "rerun", "xarray")
    optional = (requirement for extra in users for requirement in extras[extra])
    declared = library_names((*project["dependencies"], *optional))
    declared |= {name for library in declared for name in library_names(requires(library) or ())}
    distributions = packages_distributions()
    wrong = []
    for here, path in {**MACHINE, **PLUGINS}.items():
        for package in {module.partition(".")[0] for module, _ in imports(path)}:
            names = {canonicalize_name(name) for name in distributions.get(package, [package])}
            is_ours = package.partition("_")[0] == "nodegraph"
            if not (is_ours or package in sys.stdlib_module_names or names & declared):
                wrong.append(f"{here} imports {package}")
    assert not wrong


def library_names(requirements: Iterable[str]) -> set[str]:
    return {canonicalize_name(Requirement(text).name) for text in requirements}


def test_a_module_with_kernels_takes_nothing_from_other_modules_of_its_package() -> None:
    with_kernels = [path for path in PLUGINS.values() if ("nodegraph", "kernel") in imports(path)]
    assert "stepwise_kernel.py" in {path.name for path in with_kernels}
    for path in with_kernels:
        assert not [module for module, _ in imports(path) if module.startswith("nodegraph_")], path


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph: nx.DiGraph[str] = nx.DiGraph()
    everything = MACHINE | PLUGINS
    for here, path in everything.items():
        if path.name == "__init__.py":
            continue  # a front only hands on names of its modules
        for module, name in imports(path):
            target = f"{module}.{name}" if f"{module}.{name}" in everything else module
            if target in everything and target != here:
                graph.add_edge(here, target)
    circles = [sorted(group) for group in nx.strongly_connected_components(graph) if len(group) > 1]
    assert not circles


def test_installed_plugins_import_no_heavy_library() -> None:
    code = (
        "import sys; from nodegraph.plugin.registry import Registry; Registry.installed();"
        f"print(*sorted({HEAVY} & set(sys.modules)))"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", code]
    result = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert result.stdout.split() == []


def test_the_machine_has_no_word_of_motion_capture() -> None:
    wrong = []
    for module, path in MACHINE.items():
        for name in set(identifiers(path)) - NAMES_OF_PLUGGY:
            words = {word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+", name)}
            if words & WORDS_OF_THE_FIELD:
                wrong.append(f"{module} has the name {name!r}")
    assert not wrong


def identifiers(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            yield node.name
        elif isinstance(node, (ast.arg, ast.keyword)):
            yield node.arg or ""
