"""Documents compiled by LaTeX, where it is installed."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

needs_latex = pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no TeX is installed")


def compiled(folder: Path, packages: str, text: str) -> str:
    """Write paper.tex, which uses packages, compile it to paper.pdf, and return what TeX said."""
    document = folder / "paper.tex"
    document.write_text(
        rf"\documentclass{{article}}\usepackage{{{packages}}}\begin{{document}}{text}\end{{document}}"
    )
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", document.name]
    done = subprocess.run(command, cwd=folder, capture_output=True, check=False)
    log = done.stdout.decode(errors="replace")
    assert done.returncode == 0, log
    return log
