"""``site`` says what changed between the runs of one study."""

from __future__ import annotations

from html import unescape
from pathlib import Path

from tests.nodegraph.cli.conftest import Command


def test_what_changed_between_runs_is_said_as_in_diff(command: Command) -> None:
    for start in ("5", "5", "6"):
        graph = Path("toy.yaml").read_text().replace("start: 5", f"start: {start}")
        Path("toy.yaml").write_text(graph)
        place = f"runs/{len([*Path().glob('runs/*')])}"
        assert command("run", "toy.yaml", "--store", "kept", "--out", place)[0] == 0
    assert command("site", "runs", nodes=False)[0] == 0
    page = unescape(Path("site", "toy.html").read_text())
    assert page.count("Nothing: 9 combinations, all with the same results.") == 1
    assert "<li>input start was 5, now 6</li>" in page
    assert "<li>a: start was 5, now 6</li>" in page
    Path("runs", "1", "run.json").write_text("{}")
    assert command("site", "runs", nodes=False)[0] == 0
    assert Path("site", "toy.html").read_text().count("cannot be read") == 2
