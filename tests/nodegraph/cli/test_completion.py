"""A shell completes commands, options and installed names."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import Command


@pytest.mark.skipif(not shutil.which("bash"), reason="no bash is installed")
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["che"], ["check"]),
        (["run", "--onl"], ["--only"]),
        (["run", "graph.yaml", "--no-c"], ["--no-cache"]),
        (["run", "gra"], []),
    ],
)
def test_bash_completes(command: Command, words: list[str], expected: list[str]) -> None:
    status, script, _ = command("completion", "bash", nodes=False)
    assert status == 0
    Path("complete").write_text(script)
    line = " ".join(["nodegraph", *words])
    call = f"source complete; COMP_WORDS=({line}) COMP_CWORD={len(words)}; _nodegraph"
    result = subprocess.run(
        ["bash", "-c", f'{call}; printf "%s\\n" "${{COMPREPLY[@]}}"'],
        capture_output=True,
        text=True,
        check=True,
    )
    assert sorted(result.stdout.split()) == expected


def test_another_shell_ends_with_2(command: Command) -> None:
    assert command("completion", "tcsh", nodes=False)[0] == 2
