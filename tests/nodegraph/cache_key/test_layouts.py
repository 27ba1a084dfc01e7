"""A helper two modules away counts wherever a plugin lies: installed, editable, file or folder."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from pathlib import Path

import pytest

from nodegraph.cache_key import Reached, code_of
from nodegraph.plugin.registry import Registry
from tests.texts import edit

from .conftest import Folder

NODES = """
    from nodegraph import hookimpl, node
    {outer}

    @node("acme.far")
    def far(x: float) -> float:
        return {used}(x)

    @hookimpl
    def nodegraph_nodes():
        return (far,)
"""
PACKAGE = {
    "acme/__init__.py": """
        from nodegraph import hookimpl
        from acme.near import near

        @hookimpl
        def nodegraph_nodes():
            from acme.far import far
            return (far, near)
    """,
    "acme/far.py": """
        from nodegraph import node
        from acme.outer import outer

        @node("acme.far")
        def far(x: float) -> float:
            return outer(x)
    """,
    "acme/near.py": """
        from nodegraph import node

        @node("acme.near")
        def near(x: float) -> float:
            return x
    """,
    "acme/outer.py": "def outer(x):\n    from acme_core import inner\n    return inner(x)",
    "acme_core.py": "def inner(x): return x",
}
ABOUT = {
    "acme-1.dist-info/METADATA": "Metadata-Version: 2.1\nName: acme\nVersion: 1\n",
    "acme-1.dist-info/entry_points.txt": "[nodegraph]\nacme = acme\n",
}
RECORD = {"acme-1.dist-info/RECORD": "acme/__init__.py,,\nacme_core.py,,\n"}
ALONE = {
    "lone.py": NODES.format(outer="from acme_outer import outer", used="outer"),
    "acme_outer.py": "from acme_core import inner\ndef outer(x): return inner(x)",
    "acme_core.py": "def inner(x): return x",
    "acme_near.py": "def near(x): return x",
}


def written(folder: Folder, files: Mapping[str, str], place: str = "") -> Path:
    folder.write({f"{place}{name}": text for name, text in files.items()})
    return folder.path / place


@pytest.fixture
def installed(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = written(folder, {**PACKAGE, **ABOUT, **RECORD}, "lib/site-packages/")
    monkeypatch.syspath_prepend(path)
    return path


@pytest.fixture
def editable(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.syspath_prepend(written(folder, ABOUT, "lib/site-packages/"))
    path = written(folder, PACKAGE, "sources/")
    monkeypatch.syspath_prepend(path)
    return path


@pytest.fixture
def single_file(folder: Folder) -> Path:
    return written(folder, ALONE)


def reached(folder: Folder, path: Path) -> Reached:
    """Return the code of the node, as another process would find it."""
    folder.forget()
    importlib.invalidate_caches()
    registry = Registry.installed([file for file in (path / "lone.py",) if file.exists()])
    result = code_of(registry).of(registry.find("acme.far").node.function)
    assert not result.unstable
    return result


@pytest.mark.parametrize("layout", ["installed", "editable", "single_file"])
def test_an_edit_far_away_counts_and_one_of_a_sibling_does_not(
    folder: Folder, layout: str, request: pytest.FixtureRequest
) -> None:
    path: Path = request.getfixturevalue(layout)
    before = reached(folder, path)
    sibling = path / ("acme_near.py" if layout == "single_file" else "acme/near.py")
    edit(sibling, "return x", "return -x")
    assert reached(folder, path) == before
    helper = path / "acme_core.py"
    helper.write_text("def inner(x):\n    '''Documented.'''\n    return x  # as it is\n")
    assert reached(folder, path) == before
    helper.write_text("def inner(x): return -x")
    after = reached(folder, path)
    assert after.digest != before.digest
    assert {name for name in after.units if after.units[name] != before.units[name]} == {
        "acme_core"
    }
