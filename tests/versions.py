"""Install the checkout with each Python and with its oldest dependencies, run, verify, test.

``python -m tests.versions`` does so for all of `CASES`, ``python -m tests.versions 3.13`` for those
whose name begins so. It needs uv, which downloads a Python that is not installed, and runs the
whole suite for each; the status is 0 if all is well everywhere.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from tests.environments import BIN, ROOT, run
from tests.readmes import blocks


@dataclass(frozen=True)
class Case:
    """A Python with the newest dependencies that are allowed, or with the oldest."""

    python: str
    resolution: str = "highest"

    @property
    def name(self) -> str:
        """How the case is called: ``3.11 lowest-direct``."""
        return f"{self.python} {self.resolution}"

    @property
    def options(self) -> tuple[str, ...]:
        """Options of pytest: two processes, and no error for a warning of an old library."""
        return ("-n", "2", *(("-W", "default") if self.resolution != "highest" else ()))

    def check(self, folder: Path) -> str:
        """Return what failed, with its output; empty if nothing did."""
        venv = folder / "venv"
        python = venv / BIN / "python"
        program = str(python.with_name("nodegraph"))
        graph = folder / "study.yaml"
        graph.write_text(blocks((ROOT / "README.md").read_text(encoding="utf-8"), "yaml")[0])
        few = ("--axis", "trial=0,1", "--only", "length=15")
        try:
            run("uv", "venv", "--quiet", "--seed", "--python", self.python, str(venv))
        except AssertionError as error:
            return f"there is no Python {self.python} here, and uv could not get it:\n{error}"
        for words in (
            (
                *("uv", "pip", "install", "--quiet", "--compile-bytecode", "--python", str(python)),
                *("--resolution", self.resolution, "-e", f"{ROOT}[test]"),
            ),
            (program, "run", str(graph), *few, "--out", str(folder / "run")),
            (program, "lock", str(graph), *few),
            (program, "verify", str(graph.with_suffix(".lock")), "--rerun"),
            (str(python), "-m", "pytest", "-q", "-p", "no:cacheprovider", *self.options),
        ):
            variables = {"NODEGRAPH_STORE": str(folder / "store"), "PYTHONDONTWRITEBYTECODE": "1"}
            try:
                run(*words, cwd=ROOT, variables=variables)
            except AssertionError as error:
                return str(error)
        return ""


CASES = (Case("3.11", "lowest-direct"), Case("3.11"), Case("3.12"), Case("3.13"))


def main(beginning: str = "") -> int:
    """Check the cases whose name begins like this; return the exit status."""
    if shutil.which("uv") is None:
        sys.exit("it needs uv: pip install uv")
    cases = [case for case in CASES if case.name.startswith(beginning)]
    if not cases:
        sys.exit(f"no case begins with {beginning!r}; there is: {', '.join(c.name for c in CASES)}")
    status = 0
    for case in cases:
        start = time.monotonic()
        with tempfile.TemporaryDirectory(prefix="nodegraph-versions-") as folder:
            failure = case.check(Path(folder))
        minutes = (time.monotonic() - start) / 60
        print(f"{case.name}: {'failed' if failure else 'passed'} ({minutes:.1f} min)", flush=True)
        if failure:
            print(failure, flush=True)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
