"""Shipped graphs, run twice, and with their methods' code edited between."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from tests.records import read_record
from tests.studies import FILL, ONE, ROOT, Studies, command, few

STEPWISE = ("guenter", "lin_ouhyoung", "muscle", "waters")
FILLS = f"fill={','.join(STEPWISE)},cubic,ridge"
SMALL = (*ONE, "--only", FILLS)


def edit(file: Path, old: str, new: str) -> None:
    """Change a file, as an editor does some time after it was last written."""
    text = file.read_text()
    assert text.count(old) == 1, f"{file} has {old!r} {text.count(old)} times"
    status = file.stat()
    file.write_text(text.replace(old, new))
    os.utime(file, ns=(status.st_atime_ns, status.st_mtime_ns + 5_000_000_000))


def computed(record: dict[str, Any]) -> set[str]:
    """Return the nodes, with their method where there are several, that were computed."""
    steps = [step for step in record["steps"] if step["state"] == "done" and not step.get("stored")]
    return {f"{step['node']} {step['labels'].get('fill', '')}".strip() for step in steps}


@pytest.mark.parametrize("name", ["fill", "live", "spline_orders"])
def test_a_second_run_computes_nothing_and_writes_the_same(studies: Studies, name: str) -> None:
    earlier = studies.few(name)
    later = studies.run(name, *few(name))
    first, second = read_record(earlier), read_record(later)
    states = Counter(step["state"] for step in second["steps"])
    assert second["counts"] == {**second["counts"], "done": 0, "failed": 0, "unneeded": 0}
    assert second["counts"]["stored"] == states["done"]
    assert states["done"] == first["counts"]["done"] + first["counts"]["stored"]
    digests = [[step.get("digests") for step in run["steps"]] for run in (first, second)]
    assert digests[0] == digests[1]
    for path in earlier.rglob("*"):
        if path.suffix in (".csv", ".tex", ".svg"):
            assert (later / path.relative_to(earlier)).read_bytes() == path.read_bytes(), path.name


def test_an_edited_helper_reruns_what_depends_on_it_and_a_comment_nothing(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "plugins", tmp_path / "plugins")
    (tmp_path / "fill.yaml").write_text(FILL)
    run = ("run", "fill.yaml", *SMALL)
    assert command(*run, folder=tmp_path).status == 0
    everything = computed(read_record(tmp_path / "runs" / "fill"))
    assert {"capture", "gaps", "fill muscle", "fill cubic", "error muscle", "table"} <= everything
    fills = tmp_path / "plugins" / "nodegraph_fill"
    edit(fills / "cubic.py", "def cubic(", "# a remark\n\n\ndef cubic(")
    edit(fills / "whole_take.py", "from __future__", "# another\nfrom __future__")
    helper = "reach = gaps.stop.max(initial=0) + 1", "reach = 1 + gaps.stop.max(initial=0)"
    edit(fills / "stepwise.py", *helper)
    path = os.pathsep.join([str(tmp_path / "plugins"), str(ROOT)])
    process = subprocess.run(
        [sys.executable, "-m", "nodegraph.cli.main", *run],
        env={**os.environ, "PYTHONPATH": path}, cwd=tmp_path, capture_output=True, check=False,
    )  # fmt: skip
    assert process.returncode == 0, process.stderr.decode()
    changed = {f"{node} {name}" for node in ("fill", "error") for name in STEPWISE}
    assert computed(read_record(tmp_path / "runs" / "fill")) == {*changed, "table"}
