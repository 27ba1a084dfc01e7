"""Required packages: versions are compared, and the command to install is named."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import PackageNotFoundError

import pytest

from nodegraph.graph import Graph, methods

INSTALLED = {"lips": "1.2.0", "chin": "2.0rc1"}
TEXT = "nodes: {{a: {{use: read.number}}}}\nrequires: [@@'{0}']"


@pytest.fixture(autouse=True)
def _installed(monkeypatch: pytest.MonkeyPatch) -> None:
    def version(name: str) -> str:
        if name not in INSTALLED:
            raise PackageNotFoundError(name)
        return INSTALLED[name]

    monkeypatch.setattr(methods, "version", version)


@pytest.mark.parametrize(
    "wanted",
    [
        "lips",
        "lips>=1,<2",
        "lips[extra]>=1.2",
        "chin>=2.0rc0",
        "chin>=1",
        "nose>=1; python_version<'3'",
        "lips @ https://example.org/lips.zip",
    ],
)
def test_an_installed_version_that_matches(graph_of: Callable[..., Graph], wanted: str) -> None:
    text = TEXT.format(wanted.replace("'", "''"))
    assert graph_of(text.replace("@@", "")).nodes


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [
        ("lips>=1.3", "requires lips>=1.3, but 1.2.0 is installed\n    pip install 'lips>=1.3'"),
        ("lips<1", "requires lips<1, but 1.2.0 is installed\n    pip install 'lips<1'"),
        ("chin>=2", "requires chin>=2, but 2.0rc1 is installed\n    pip install 'chin>=2'"),
        ("nose", "requires nose, but it is not installed\n    pip install 'nose'"),
        ("nose>=", "requires: 'nose>=' is not a package\n    write a package as pip takes it"),
    ],
)
def test_a_missing_or_other_version_is_reported_with_the_command_to_install(
    problems_of: Callable[..., list[object]], wanted: str, expected: str
) -> None:
    [problem] = problems_of(TEXT.format(wanted))
    assert expected in str(problem)


def test_a_missing_plugin_and_its_node_are_both_reported(
    problems_of: Callable[..., list[object]],
) -> None:
    text = "requires: [@@nose>=2]\nnodes: {a: {use: @@fill.nose}}"
    first, second = problems_of(text)
    assert "pip install 'nose>=2'" in str(first)
    assert "no node 'fill.nose'" in str(second)
