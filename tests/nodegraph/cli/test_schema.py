"""``nodegraph schema``."""

from __future__ import annotations

import json
from pathlib import Path

import yaml
from jsonschema import Draft202012Validator

from nodegraph.plugin import loading
from tests.nodegraph.cli.conftest import Command


def test_it_prints_a_schema_with_the_nodes_of_a_named_file(command: Command) -> None:
    status, out, _ = command("schema")
    schema = json.loads(out)
    assert status == 0
    Draft202012Validator.check_schema(schema)
    names = {node.get("const") for node in schema["$defs"]["node name"]["oneOf"]}
    assert {"toy.cut", "fill.hold"} <= names
    graph = yaml.safe_load(Path("toy.yaml").read_text())
    assert Draft202012Validator(schema).is_valid(graph)
    graph["nodes"]["gaps"]["with"]["length"] = 0
    assert not Draft202012Validator(schema).is_valid(graph)


def test_it_writes_the_same_to_a_file(command: Command) -> None:
    printed = command("schema")[1]
    path = Path("made/toy.schema.json")
    status, out, _ = command("schema", "--out", str(path))
    assert status == 0
    assert out.startswith(f"{path} (")
    assert path.read_text(encoding="utf-8") == printed


def test_without_any_node_it_is_still_a_schema(command: Command) -> None:
    status, out, _ = command("schema", nodes=False)
    assert status == 0
    Draft202012Validator.check_schema(json.loads(out))
    bare = {"nodegraph": 1, "nodes": {"a": {"use": "./clean.yaml"}}}
    assert loading.installed() == ([], [])
    assert Draft202012Validator(json.loads(out)).is_valid(bare)


def test_a_folder_that_cannot_be_made_is_an_error(command: Command) -> None:
    status, _, err = command("schema", "--out", "toys.py/toy.schema.json")
    assert status == 2
    assert "toys.py" in err
