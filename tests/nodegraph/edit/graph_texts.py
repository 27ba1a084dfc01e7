"""Texts of graph files in all the forms that people write, drawn from a seed."""

from __future__ import annotations

import random

_COMMENTS = ("# a word", "# größer als 5 mm: [no, list]", "#", "# - no item")


class Writer:
    """Writes one graph file; the same seed gives the same text.

    Attributes
    ----------
    text : str
    fills : list of str
        Names of its nodes with one method, `fill` first.
    """

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self.fills = ["fill", *(f"step_{number}" for number in range(self._random.randrange(4)))]
        lines = self._lines()
        text = "\n".join(lines) + ("" if self._chance(0.2) else "\n")
        if self._chance(0.2):
            text = text.replace("\n", "\r\n")
        self.text = ("\ufeff" if self._chance(0.1) else "") + text

    def _chance(self, share: float) -> bool:
        return self._random.random() < share

    def _comment(self) -> str:
        return f"  {self._random.choice(_COMMENTS)}" if self._chance(0.25) else ""

    def _lines(self) -> list[str]:
        lines = ["nodegraph: 1" + self._comment()]
        titles = ["title: Gesichter, 日本", "title: 'it''s'", 'title: "a # b"']
        lines.append(self._random.choice(titles) + self._comment())
        if self._chance(0.5):
            lines += self._random.choice(
                [
                    ["notes: |", "  One: two", "", "  # no comment", "    deeper"],
                    ["notes: >-", "  folded", "  text"],
                    ["notes: plain", "  and longer"],
                ]
            )
        lines += self._spaces()
        lines += ["axes:" + self._comment()]
        lines += self._random.choice(
            [["  trial: {count: 2}"], ["  trial: [0, 1]  # drawn"], ["  trial:", "  - 0", "  - 1"]]
        )
        lines += self._random.choice(
            [["  length: [5, 15]"], ["  length:", "    short: 5", "    long:  15   # frames"]]
        )
        lines += self._spaces()
        lines += ["nodes:" + self._comment()]
        lines += ["  capture: {use: read.recording, with: {path: 'sample:face'}}" + self._comment()]
        lines += ["  gaps:" + self._comment(), "    use: gaps.cut", *self._wiring("capture")]
        lines += [f"    with: {{length: $length, seed: $trial}}{self._comment()}"]
        source = "gaps.gappy"
        for name in self.fills:
            lines += self._spaces() + self._fill(name, source)
            source = name
        lines += self._error(source)
        if self._chance(0.5):
            lines += ["skip:", "  - {trial: 1, length: 15}" + self._comment()]
        lines += self._random.choice(
            [["report: [error]"], ["report:", "- show: error", "  title: x", "- error"]]
        )
        return lines

    def _spaces(self) -> list[str]:
        return self._random.choice([[], [], [""], ["  # between"], ["", "# above", ""]])

    def _wiring(self, source: str) -> list[str]:
        return self._random.choice(
            [
                [f"    in: {source}" + self._comment()],
                [f"    in: {{recording: {source}}}"],
                [f"    in: {{from: {source}}}"],
                ["    in:", f"      recording: {source}" + self._comment()],
            ]
        )

    def _fill(self, name: str, source: str) -> list[str]:
        width = self._random.randrange(3) * " "
        return self._random.choice(
            [
                [f"  {name}:{width} {{use: fill.muscle, in: {source}}}" + self._comment()],
                [f"  {name}: {{use: fill.muscle, in: {source}, }}"],
                [
                    f"  {name}: {{use: fill.muscle,  # in two lines",
                    f"    in: {source}, with: {{neighbours: 3}} }}",
                ],
                [f"  {name}:", "    use: fill.muscle" + self._comment(), *self._wiring(source)],
                [
                    f"  {name}:",
                    *self._wiring(source),
                    "    with:" + self._comment(),
                    f"      neighbours:{width} 3" + self._comment(),
                    "      # the last",
                    "    use: fill.muscle",
                ],
                [f"  {name}:", "    use: fill.muscle", "    with:", *self._wiring(source)],
            ]
        )

    def _error(self, source: str) -> list[str]:
        anchored = self._random.choice(
            [
                ["      truth: gaps.truth", "      hidden: gaps.hidden"],
                ["      truth: &truth {from: gaps.truth}", "      hidden: gaps.hidden"],
            ]
        )
        lines = [
            "  error:",
            "    use: score.gaps",
            "    in:",
            f"      estimate: {source}",
            *anchored,
        ]
        if "&truth" in anchored[0]:
            lines += [
                "  again:",
                "    use: score.gaps",
                f"    in: {{estimate: {source}, truth: *truth,",
            ]
            lines += ["         hidden: gaps.hidden}"]
        return lines
