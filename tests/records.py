"""The record of a run as plain data: ``run.json`` with the steps of ``steps.jsonl.gz``."""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any


def read_record(folder: Path | str) -> dict[str, Any]:
    """Return the record in a folder."""
    data: dict[str, object] = json.loads(Path(folder, "run.json").read_text())
    return data | {"steps": steps_of(Path(folder, "steps.jsonl.gz").read_bytes())}


def steps_of(content: bytes) -> list[dict[str, object]]:
    """Return the steps in the content of their file."""
    return [json.loads(line) for line in gzip.decompress(content).splitlines()]


def write_steps(folder: Path | str, steps: Iterable[object]) -> None:
    """Write other steps."""
    text = "".join(f"{json.dumps(step)}\n" for step in steps)
    Path(folder, "steps.jsonl.gz").write_bytes(gzip.compress(text.encode()))
