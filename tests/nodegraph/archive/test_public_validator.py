"""Archives pass the public validator of RO-Crates."""

from __future__ import annotations

import json
import shutil
import sys
import zipfile
from pathlib import Path

from tests.environments import run
from tests.studies import ROOT, Studies, command
from tests.texts import edit

PROFILES = [
    *("process-run-crate-0.5", "ro-crate-1.1", "workflow-ro-crate-1.0"),
    "workflow-run-crate-0.5",
]
"""The profile of an archive, and those from which it inherits."""


def test_an_archive_is_a_crate_of_its_profiles_and_is_none_without_its_workflow(
    studies: Studies, tmp_path: Path
) -> None:
    ran = str(studies.few("procrustes_example"))
    ended = command("archive", ran, "--out", "ran.zip", folder=tmp_path)
    assert ended.status == 0, ended.err
    with zipfile.ZipFile(tmp_path / "ran.zip") as file:
        file.extractall(tmp_path / "whole")
    shutil.copytree(tmp_path / "whole", tmp_path / "without")
    metadata = tmp_path / "without" / "ro-crate-metadata.json"
    edit(metadata, '"mainEntity"', '"mentions"')
    program = (sys.executable, "-m", "tests.nodegraph.archive.validator", "whole", "without")
    paths = {"PYTHONPATH": str(ROOT)}
    lines = run(*program, cwd=tmp_path, variables=paths).stdout.splitlines()
    whole, without = map(json.loads, lines)
    assert whole == {"profiles": PROFILES, "issues": []}
    assert without["issues"]
