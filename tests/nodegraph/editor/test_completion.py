"""What may stand at a place, in a text that is being written."""

from __future__ import annotations

import pytest

from nodegraph.editor.completion import about, options_at
from nodegraph.plugin.registry import Registry

TEXT = """\
nodegraph: 1
inputs: {rate: 60}
axes:
  length: [5, 15]
nodes:
  capture: {use: read.recording, with: {path: "sample:face"}}
  gaps:
    use: gaps.cut
    in: capture
    with: {length: $length,
      pattern: scattered}
  fill:
    in: gaps.gappy
    alternatives:
      muscle: {use: fill.muscle}
      other:
        use: fill.linear
        with:
          max_gap: 3
  rest: {in: gaps, alternatives: [fill.pchip, fill.akima], with: {max_gap: 4}}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth}}
  table: {use: compare.table, in: error, over: [length]}
notes: |
  use: nothing
report:
  - show: table
    at: {length: 5}
- error
"""


@pytest.mark.parametrize(
    ("before", "word", "there", "not_there"),
    [
        ("\nno", "no", {"nodes", "axes", "report"}, {"use"}),
        ("capture: {us", "us", {"use", "in", "with", "alternatives"}, {"nodes"}),
        ("use: read.re", "read.re", {"read.recording", "fill.muscle"}, {"fill.*"}),
        ("\n    use: gaps.", "gaps.", {"gaps.cut"}, set()),
        ("with: {le", "le", {"length", "seed"}, {"max_gap"}),
        ("with: {length: $le", "$le", {"$length", "$rate"}, set()),
        ("\n      pat", "pat", {"pattern", "length"}, set()),
        ("pattern: sc", "sc", {"$length"}, {"length"}),
        ("\n    in: ga", "ga", {"capture", "gaps", "gaps.gappy", "gaps.truth"}, {"length"}),
        ("\n      other:\n        us", "us", {"use", "in", "with"}, {"over"}),
        ("\n          ma", "ma", {"max_gap", "ends"}, {"length"}),
        ("[fill.pchip, fi", "fi", {"fill.*", "fill.akima"}, {"fill"}),
        ("akima], with: {max", "max", {"max_gap"}, {"length"}),
        ("score.gaps, in: {es", "es", {"estimate", "truth", "hidden"}, {"gaps"}),
        ("{estimate: fi", "fi", {"fill", "gaps.gappy"}, {"estimate"}),
        ("over: [le", "le", {"length"}, {"gaps"}),
        ("- sh", "sh", {"show", "title", "gaps.truth"}, {"use"}),
        ("- show: ta", "ta", {"table", "error"}, {"title"}),
        ("at: {le", "le", {"length"}, {"table"}),
        ("\n- er", "er", {"error", "show"}, {"nodes"}),
    ],
)
def test_words_that_fit_are_offered(
    registry: Registry, before: str, word: str, there: set[str], not_there: set[str]
) -> None:
    start = TEXT.index(before) + len(before)
    for text in (TEXT, TEXT[:start]):  # also at the end of a text that is not complete
        found, options = options_at(text, start, registry)
        words = {option.word for option in options}
        assert found == word
        if text is TEXT:
            assert there <= words
        assert not not_there & words


@pytest.mark.parametrize("before", ["  use: noth", "nodegraph: 1", "{rate: 6", "# a comment: {us"])
def test_prose_and_numbers_are_left_alone(registry: Registry, before: str) -> None:
    text = TEXT + "# a comment: {use: x}\n"
    assert options_at(text, text.index(before) + len(before), registry)[1] == []


@pytest.mark.parametrize(
    ("before", "word", "said"),
    [
        ("axe", "axes", "A list, labels"),
        ("use: read.re", "read.recording", "Read a recording"),
        ("with: {len", "length", "Frames that an event hides. Whole number >= 1, in frames."),
        ("\n          max", "max_gap", "Gaps longer than this stay missing"),
        ("in: {estimate: fi", "fill", "fill.muscle: "),
        ("score.gaps, in: {est", "estimate", ""),
        ("\n  ga", "gaps", "Hide measured samples"),
        ("truth: gaps.tr", "gaps.truth", "Out: gappy: Trajectories, truth: Truth[Trajectories]"),
    ],
)
def test_the_word_at_the_cursor_is_explained(
    registry: Registry, before: str, word: str, said: str
) -> None:
    start = TEXT.index(before) + len(before)
    for place in (start - 1, start, start + 1):
        option = about(TEXT, place, registry)
        assert option is not None
        assert option.word == word
        assert said in " ".join(option.about)
    assert about(TEXT, TEXT.index("noth") + 2, registry) is None
    assert about("", 0, registry) is None
