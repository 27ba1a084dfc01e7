"""The blocks of code in a README, and the commands of its shell blocks."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from nodegraph.cli.main import main

ROOT = Path(__file__).parents[1]
FEW = {
    "length: [5, 15, 45]": "length: [5, 45]",
    "alternatives: fill.*": "alternatives: [fill.muscle, fill.linear, fill.cubic]",
}
"""Makes the study of fills small."""


def blocks(text: str, language: str) -> list[str]:
    """Return the blocks of one language in a page of Markdown."""
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def commands(text: str) -> Iterator[list[str]]:
    """Yield the words of every command in the shell blocks of a page."""
    for block in blocks(text, "sh"):
        for line in block.splitlines():
            words = shlex.split(line, comments=True)
            while "&&" in words:
                yield words[: words.index("&&")]
                words = words[words.index("&&") + 1 :]
            if words:
                yield words


def is_ours(words: list[str]) -> bool:
    """Return whether a command is one of the program's."""
    return Path(words[0]).name == "nodegraph"


def run_command(words: list[str]) -> None:
    """Run a command of the program; it must succeed, and write the files that it names."""
    assert main(words[1:]) == 0, words
    for option, value in pairwise(words):
        if option == "--out":
            assert list(Path().glob(f"{value}*")), words


def write_small_study(path: Path) -> None:
    """Write the study of fills on two faces with a few labels, without its drawings."""
    text = (ROOT / "graphs" / "fill.yaml").read_text().partition("  equal_terms:\n")[0]
    # no comparison that is left is of the other terms
    left_out = "face_[^12]|0.1 mm noise|movement|as_published|tuned"
    text = re.sub(rf" +({left_out}): .*\n", "", text)
    text += "report: [table, ranks.table, ranks.figure]\n"
    for long, short in FEW.items():
        assert long in text
        text = text.replace(long, short)
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
