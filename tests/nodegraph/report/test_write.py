"""A finished run is written into its folder, whatever a part of it holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from nodegraph.execute.results import Run
from nodegraph.execute.settings import RunSettings
from nodegraph.report.write import write_run
from nodegraph.runs.folder import RunFolder


def test_a_command_that_is_not_valid_text_costs_no_report(
    run_of: Callable[..., Run], tmp_path: Path
) -> None:
    run = run_of("nodes: {a: {use: read.number, with: {start: -1}}, b: {use: strict.fails, in: a}}")
    folder = RunFolder(tmp_path / "run", "")
    written = write_run(replace(run, settings=RunSettings("\udc80.yaml")), folder)
    folder.close()
    assert not written.lost
    assert b"\\udc80.yaml" in (tmp_path / "run" / "report.html").read_bytes()
