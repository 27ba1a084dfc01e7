"""Start-up of whole processes, in an environment that holds a normal install and no more."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from tests.benchmarks.conftest import Clock

ROOT = Path(__file__).parents[2]
CASE = "start-up of a process, ms"
COMMANDS = {
    "nodegraph": ["nodegraph", "--help"],
    "nodegraph check": ["nodegraph", "check", str(ROOT / "graphs" / "fill.yaml")],
    "nodegraph show": ["nodegraph", "show"],
    "python -c pass": ["python", "-c", "pass"],
    "import argparse": ["python", "-c", "import argparse"],
    "import numpy": ["python", "-c", "import numpy"],
    "import numpy, networkx": ["python", "-c", "import numpy, networkx"],
}


@pytest.fixture(scope="module")
def programs() -> Iterator[Path]:
    """Install the project, with what it needs, into an environment of its own."""
    with TemporaryDirectory() as folder:
        venv.create(folder, with_pip=False)
        programs = Path(folder, "Scripts" if os.name == "nt" else "bin")
        install = [sys.executable, "-m", "pip", "--python", str(programs / "python"), "install"]
        subprocess.run([*install, "--quiet", str(ROOT)], check=True, env=_environment())
        yield programs


@pytest.mark.parametrize("name", COMMANDS)
def test_start_up(name: str, clock: Clock, programs: Path, tmp_path: Path) -> None:
    program, *rest = COMMANDS[name]
    command = [str(programs / program), *rest]

    def start() -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            command, cwd=tmp_path, env=_environment(), capture_output=True, text=True, check=True
        )

    done = clock(CASE, name, "ms", start, scale=1e3, rounds=15)
    assert done.stdout or program == "python"


def _environment() -> dict[str, str]:
    """Return the environment without what would lead to other copies of the project."""
    return {name: text for name, text in os.environ.items() if name != "PYTHONPATH"}
