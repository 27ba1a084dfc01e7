"""A run that is killed loses nothing that it has finished."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the program that is killed forks")
def test_twenty_kills_cost_nothing_that_was_finished(tmp_path: Path) -> None:
    path = os.pathsep.join([str(ROOT), str(ROOT / "plugins")])
    program = [
        sys.executable,
        str(Path(__file__).with_name("killed.py")),
        str(tmp_path),
        "0",
        "serial",
    ]
    environment = {**os.environ, "PYTHONPATH": path}
    ended = subprocess.run(
        program, env=environment, capture_output=True, text=True, check=False, timeout=120
    )
    assert ended.returncode == 0, ended.stderr
    report = json.loads(ended.stdout)
    assert report["kills"] == 20
    assert 0 < report["done before the last run"] < 421
    assert report["computed then"] > 0
    assert report["twice"] == []
    assert report["reported"] == []
    assert report["same"]
