"""The schema and the loader, asked about the same data."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from nodegraph import GraphError
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.graphfile.schema import graph_schema
from nodegraph.plugin.registry import Registry


@dataclass(frozen=True)
class Judge:
    """What the schema says of a graph's data, and what the loader does."""

    registry: Registry
    folder: Path

    @cached_property
    def schema(self) -> dict[str, Any]:
        schema = json.loads(json.dumps(graph_schema(self.registry), allow_nan=False))
        assert isinstance(schema, dict)
        return schema

    @cached_property
    def validator(self) -> Draft202012Validator:
        return Draft202012Validator(self.schema)

    def refusals(self, data: object) -> list[str]:
        """What the schema has against it."""
        return [
            f"{problem.json_path}: {problem.message}"
            for problem in self.validator.iter_errors(data)
        ]

    def mistakes(self, data: object) -> list[str]:
        """What the loader has against it; JSON is YAML that means the same."""
        text = json.dumps(data, ensure_ascii=False)
        try:
            build(read_graph_text(text, "graph.yaml", self.folder), self.registry)
        except GraphError as error:
            return [str(problem) for problem in error.problems]
        return []


@pytest.fixture(scope="session")
def judge_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Judge]:
    """Make a judge of graphs of these nodes, in a folder with the file ``a.txt``."""
    folder = tmp_path_factory.mktemp("graphs")
    (folder / "a.txt").write_text("1")

    def make(nodes: Iterable[Callable[..., object]]) -> Judge:
        return Judge(Registry.of(nodes, plugin="toys"), folder)

    return make


def parts_of(judge: Judge, node: str) -> Any:
    """Return the schema of what may stand beside the ``use`` of a node."""
    rules = judge.schema["$defs"]["nodes"]["allOf"][1:]
    return next(
        rule["then"]["properties"]
        for rule in rules
        if node in rule["if"]["properties"]["use"]["enum"]
    )


def settings_of(judge: Judge, node: str) -> Any:
    """Return the schema of each setting of a node."""
    return parts_of(judge, node)["with"]["properties"]
