"""What the page on clusters shows is what dask-jobqueue and the Dask operator take."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest
import yaml

from tests.readmes import ROOT, blocks

PAGE = (ROOT / "nodegraph" / "site" / "pages" / "clusters.md").read_text()


def test_slurm_gets_a_job_that_starts_a_worker(tmp_path: Path) -> None:
    pytest.importorskip("dask_jobqueue")
    (code,) = blocks(PAGE, "python")
    path = tmp_path / "slurm_cluster.py"
    path.write_text(code.replace('"port": 8786', '"port": 0'))
    with runpy.run_path(str(path))["cluster"]() as cluster:
        script, address = cluster.job_script(), cluster.scheduler_address
    lines = script.splitlines()
    assert {"#SBATCH -p normal", "#SBATCH --cpus-per-task=8", "#SBATCH -t 02:00:00"} <= set(lines)
    *_, before, worker = lines
    assert before == "source .venv/bin/activate"
    assert worker.startswith(f"python -m distributed.cli.dask_worker {address} ")
    assert "--nthreads 8" in worker


def test_the_operator_gets_the_cluster_that_it_makes_itself() -> None:
    operator = pytest.importorskip("dask_kubernetes.operator")
    (text,) = blocks(PAGE, "yaml")
    ours = yaml.safe_load(text)
    theirs = operator.make_cluster_spec("nodegraph", image="nodegraph:latest", n_workers=10)
    assert (ours["apiVersion"], ours["kind"]) == (theirs["apiVersion"], theirs["kind"])
    assert ours["metadata"] == theirs["metadata"]
    assert ours["spec"]["scheduler"]["service"] == theirs["spec"]["scheduler"]["service"]
    for part in ("worker", "scheduler"):
        (container,), (same,) = (
            spec["spec"][part]["spec"]["containers"] for spec in (ours, theirs)
        )
        assert container["name"] == same["name"]
        assert "-".join(container["args"]).startswith(same["args"][0])
