"""The leak check: no method may see the truth that it is scored against."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nodegraph import GraphError, InputFile, Truth, node
from nodegraph.graph import Graph
from tests.nodegraph.conftest import ProblemsOf


class Face(NamedTuple):
    captured: float
    neutral: float
    truth: Truth[float]


@node("synthesize.face")
def face() -> Face:
    return Face(1.0, 2.0, 3.0)


@node("fill.two")
def two(recording: float, reference: float | None = None) -> float:
    return recording


@node("peek.answer")
def peek(truth: Truth[float]) -> float:
    return truth


@node("read.pair")
def read_pair(*, first: Path, second: Path) -> float:
    return 0.0


class Noisy(NamedTuple):
    noisy: float
    truth: Truth[float]


@node("noise.add")
def noise(recording: float, truth: Truth[float] | None = None) -> Noisy:
    return Noisy(recording, recording if truth is None else truth)


@node("score.speech")
def speech(estimate: float, truth: Truth[float], phonemes: str) -> float:
    return 0.0


@node("score.by_text")
def by_text(estimate: str, truth: Truth[float]) -> float:
    return 0.0


MORE = (face, two, peek, noise, speech, by_text)
TEXT = """
axes: {k: [1, 2]}
nodes:
  capture: {use: read.number}
  near: {use: fill.hold, in: capture}
  gaps: {use: gaps.cut, in: near, with: {length: $k}}
  fill: {use: fill.two, in: {recording: gaps.gappy, reference: REFERENCE}}
  smooth: {use: fill.hold, in: fill}
  error: {use: score.gaps, in: {estimate: ESTIMATE, truth: TRUTH, hidden: gaps.hidden}}
  shown: {use: plot.faces, in: {recordings: capture, truth: {from: gaps.truth, at: {k: 1}}}}
"""


def text(reference: str = "gaps.gappy", estimate: str = "smooth", truth: str = "gaps.truth") -> str:
    replaced = TEXT.replace("REFERENCE", reference)
    return replaced.replace("ESTIMATE", estimate).replace("TRUTH", truth)


def test_what_passes_the_hider_is_no_leak(graph_of: Callable[..., Graph]) -> None:
    assert graph_of(text(), more=MORE)


def test_many_ways_that_meet_again_are_followed_once(graph_of: Callable[..., Graph]) -> None:
    rungs = "".join(
        f"  {side}{at}: {{use: fill.two, in: {{recording: l{at - 1}, reference: r{at - 1}}}}}\n"
        for at in range(1, 40)
        for side in "lr"
    )
    ends = "".join(f"  {side}0: {{use: fill.hold, in: capture}}\n" for side in "lr")
    assert graph_of(text(truth="l39") + ends + rungs, more=MORE)


@pytest.mark.parametrize(
    ("written", "way"),
    [
        (text(estimate="@@capture"), "capture.output -> error.estimate"),
        (text(estimate="@@near"), "near.output -> error.estimate"),
        (
            text(reference="capture", estimate="@@smooth"),
            "capture.output -> fill.output -> smooth.output -> error.estimate",
        ),
        (
            text(reference="near", estimate="@@fill"),
            "near.output -> fill.output -> error.estimate",
        ),
    ],
)
def test_a_way_around_the_hider_is_named(problems_of: ProblemsOf, written: str, way: str) -> None:
    (problem,) = problems_of(written, more=MORE)
    assert problem.message == f"error is scored against what gaps hides, and can see it: {way}"
    assert "'known'" in problem.instead


def test_the_truth_itself_must_not_reach_an_estimate(problems_of: ProblemsOf) -> None:
    written = text(estimate="@@peeked") + "  peeked: {use: peek.answer, in: gaps.truth}\n"
    problems = problems_of(written, more=MORE)
    assert problems[0].message.endswith("gaps.truth -> peeked.output -> error.estimate")


def test_a_processed_truth_is_still_the_truth(
    problems_of: ProblemsOf, graph_of: Callable[..., Graph]
) -> None:
    more = "  peeked: {use: peek.answer, in: gaps.truth}\n"
    assert graph_of(text(truth="peeked") + more, more=MORE)
    problems_of(text(truth="peeked", estimate="@@near") + more, more=MORE)


def test_a_port_that_only_draws_is_exempt(problems_of: ProblemsOf) -> None:
    written = text(estimate="@@capture")
    assert len(problems_of(written, more=MORE)) == 1  # and none for 'shown'


@pytest.mark.parametrize(
    ("known", "leaks"),
    [
        ("[capture]", False),
        ("[capture.output]", False),
        ("[near]", False),  # what comes from it alone is not a secret either
        ("[gaps.truth]", True),
        ("[capture, near]", False),
    ],
)
def test_no_way_leads_through_what_is_known(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf, known: str, leaks: bool
) -> None:
    written = text(reference="capture") + f"known: {known}\n"
    if leaks:
        problems_of(written.replace("estimate: smooth", "estimate: @@smooth"), more=MORE)
    else:
        assert graph_of(written, more=MORE)


FACE = """
nodes:
  face: {use: synthesize.face}
  fill: {use: fill.two, in: {recording: face.captured, reference: face.neutral}}
  gaps: {use: gaps.cut, in: face.captured}
  again: {use: fill.two, in: {recording: gaps.gappy, reference: face.neutral}}
  score: {use: score.gaps, in: {estimate: fill, truth: face.truth, hidden: gaps.hidden}}
  error: {use: score.gaps, in: {estimate: @@again, truth: gaps.truth, hidden: gaps.hidden}}
"""


def test_one_output_of_a_node_may_be_known(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf
) -> None:
    (problem,) = problems_of(FACE, more=MORE)
    assert problem.message.endswith("face.neutral -> again.output -> error.estimate")
    assert graph_of(FACE.replace("@@", "") + "known: [face.neutral]\n", more=MORE)
    problems_of(FACE + "known: [gaps.truth]\n", more=MORE)


FILES = """
nodes:
  capture: {use: read.file, with: {path: a.txt}}
  other: {use: read.file, with: {path: OTHER}}
  gaps: {use: gaps.cut, in: capture}
  fill: {use: fill.two, in: {recording: gaps.gappy, reference: other}}
  error: {use: score.gaps, in: {estimate: @@fill, truth: gaps.truth, hidden: gaps.hidden}}
"""


def test_a_file_read_twice_is_one_source(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf, tmp_path: Path
) -> None:
    for name in ("a.txt", "b.txt"):
        (tmp_path / name).write_text("1")
    (tmp_path / "link.txt").symlink_to(tmp_path / "a.txt")
    assert graph_of(FILES.replace("OTHER", "b.txt").replace("@@", ""), more=MORE)
    for same in ("a.txt", "./a.txt", "link.txt"):
        (problem,) = problems_of(FILES.replace("OTHER", same), more=MORE)
        way = f"file {tmp_path / 'a.txt'} -> other.output -> fill.output -> error.estimate"
        assert problem.message.endswith(way)
    assert graph_of(FILES.replace("OTHER", "a.txt").replace("@@", "") + "known: [other]", more=MORE)


def test_one_leaking_alternative_is_enough(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf
) -> None:
    written = """
        nodes:
          capture: {use: read.number}
          gaps: {use: gaps.cut, in: capture}
          fill: {in: gaps, alternatives: {a: fill.hold, b: {use: fill.hold, in: capture}}}
          error: {use: score.gaps, in: {estimate: @@fill, truth: gaps.truth, hidden: gaps.hidden}}
        """
    problems_of(written)
    assert graph_of(written.replace("@@", "").replace(", in: capture}}", "}}"))


def test_a_graph_that_hides_nothing_has_no_leak(graph_of: Callable[..., Graph]) -> None:
    assert graph_of(
        """
        nodes:
          a: {use: read.number}
          n: {use: gaps.cut, in: b}
          b: {use: read.number}
          e: {use: score.gaps, in: {estimate: a, truth: a, hidden: n.hidden}}
        """
    )


CLEAN = """
nodes:
  face: {use: synthesize.face}
  noise: {use: noise.add, in: {recording: face.captured, truth: face.truth}}
  gaps: {use: noise.add, in: {recording: noise.noisy, truth: noise.truth}}
  fill: {use: fill.hold, in: FILL}
  error: {use: score.gaps, in: {estimate: fill, truth: TRUTH, hidden: text}}
  text: {use: text.count}
"""


@node("text.count")
def count() -> int:
    return 1


@pytest.mark.parametrize(
    ("fill", "truth", "way"),
    [
        ("gaps.noisy", "gaps.truth", ""),
        ("noise.noisy", "noise.truth", ""),
        ("face.captured", "face.truth", ""),
        ("face.captured", "noise.truth", "face.captured -> fill.output"),
        ("noise.noisy", "gaps.truth", "noise.noisy -> fill.output"),
        ("face.captured", "gaps.truth", "face.captured -> fill.output"),
    ],
)
def test_the_nearest_damaging_node_decides(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf, fill: str, truth: str, way: str
) -> None:
    written = CLEAN.replace("FILL", fill).replace("TRUTH", truth)
    if not way:
        assert graph_of(written, more=(*MORE, count))
        return
    (problem,) = problems_of(written.replace("estimate: ", "estimate: @@"), more=(*MORE, count))
    assert problem.message.endswith(f"{way} -> error.estimate")
    assert f"{truth.partition('.')[0]}.noisy" in problem.instead


@pytest.mark.parametrize("recording", ["face.truth", "noise.noisy"])
def test_the_truth_of_what_is_damaged_is_named(problems_of: ProblemsOf, recording: str) -> None:
    written = CLEAN.replace("FILL", "gaps.noisy").replace("TRUTH", "face.truth")
    written = written.replace("recording: noise.noisy", f"recording: {recording}")
    (problem,) = problems_of(written.replace("estimate: ", "estimate: @@"), more=(*MORE, count))
    assert "gaps.noisy -> fill.output -> error.estimate" in problem.message
    assert "gaps.truth" in problem.instead


def test_only_a_node_that_damages_it_takes_the_truth_at_a_plain_port(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf
) -> None:
    written = """
        nodes:
          face: {use: synthesize.face}
          gaps: {use: gaps.cut, in: face.truth}
          fill: {use: fill.hold, in: SOURCE}
          error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
        """
    assert graph_of(written.replace("SOURCE", "gaps.gappy"), more=MORE)
    for source in ("face.truth", "gaps.truth"):
        problem, *_ = problems_of(written.replace("SOURCE", f"@@{source}"), more=MORE)
        assert "must not see it" in problem.message
        assert source.replace("truth", "captured" if "face" in source else "gappy") in (
            problem.instead
        )


def test_a_port_of_a_score_other_than_its_estimate_may_come_from_anywhere(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf
) -> None:
    written = """
        nodes:
          spoken: {use: text.write, with: {text: a}}
          capture: {use: strict.spoken, in: spoken}
          gaps: {use: gaps.cut, in: capture}
          error: {use: score.speech, in: {estimate: SEEN, truth: gaps.truth, phonemes: spoken}}
          other: {use: score.by_text, in: {estimate: TEXT, truth: gaps.truth}}
          shown: {use: text.shown, in: gaps.gappy}
        """

    @node("strict.spoken")
    def spoken(words: str) -> float:
        return 1.0

    @node("text.shown")
    def shown(number: float) -> str:
        return str(number)

    more = (*MORE, spoken, shown)
    assert graph_of(written.replace("SEEN", "gaps.gappy").replace("TEXT", "shown"), more=more)
    problems_of(written.replace("SEEN", "@@capture").replace("TEXT", "shown"), more=more)
    problems_of(written.replace("SEEN", "gaps.gappy").replace("TEXT", "@@spoken"), more=more)


@pytest.mark.parametrize(
    ("known", "follows"),
    [
        ("fill", False),
        ("gaps.gappy", False),
        ("gaps.hidden", False),
        ("face.neutral", True),
        ("face.captured", False),
        ("face", True),
        ("gaps.truth", True),
        ("unrelated", True),
        ("mixed", True),
    ],
)
def test_known_must_name_what_the_check_can_follow(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf, known: str, follows: bool
) -> None:
    written = f"""
        nodes:
          face: {{use: synthesize.face}}
          unrelated: {{use: read.number}}
          gaps: {{use: gaps.cut, in: face.captured}}
          fill: {{use: fill.hold, in: gaps.gappy}}
          mixed: {{use: fill.two, in: {{recording: gaps.gappy, reference: unrelated}}}}
          error: {{use: score.gaps, in: {{estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}}}
        known: [@@{known}]
        """
    if follows:
        assert graph_of(written.replace("@@", ""), more=MORE)
    else:
        (problem,) = problems_of(written, more=MORE)
        assert known in problem.message
        assert "gaps" in problem.message


@node("read.answer")
def read_answer(*, path: InputFile) -> Truth[float]:
    return 0.0


@pytest.mark.parametrize(("path", "leaks"), [("take", False), ("take/a.txt", True)])
def test_the_truth_may_lie_in_the_folder_from_which_methods_read(
    graph_of: Callable[..., Graph],
    problems_of: ProblemsOf,
    tmp_path: Path,
    path: str,
    *,
    leaks: bool,
) -> None:
    (tmp_path / "take").mkdir()
    (tmp_path / "take" / "a.txt").write_text("1")
    written = f"""
        nodes:
          answer: {{use: read.answer, with: {{path: {path}}}}}
          capture: {{use: read.file, with: {{path: {path}}}}}
          error: {{use: score.gaps, in: {{estimate: @@capture, truth: answer, hidden: text}}}}
          text: {{use: text.count}}
        """
    more = (*MORE, count, read_answer)
    if leaks:
        (problem,) = problems_of(written, more=more)
        assert "take/a.txt -> capture.output -> error.estimate" in problem.message
    else:
        assert graph_of(written.replace("@@", ""), more=more)


def test_a_used_graph_that_damages_takes_the_truth(
    files: Callable[..., None],
    graph_of: Callable[..., Graph],
    messages_of: Callable[..., list[str]],
) -> None:
    damage = """
        inputs: {recording: float}
        nodes: {gaps: {use: gaps.cut, in: $recording}READERS}
        outputs: {gappy: gaps.gappy, truth: gaps.truth, hidden: gaps.hidden}
        """
    outer = """
        nodes:
          face: {use: synthesize.face}
          damage: {use: damage.yaml, in: @@face.truth}
          fill: {use: fill.hold, in: damage}
          error: {use: score.gaps, in: {estimate: fill, truth: damage.truth, hidden: damage.hidden}}
        """
    files(damage=damage.replace("READERS", ""))
    assert graph_of(outer.replace("@@", ""), more=MORE)
    (message,) = messages_of(
        outer, more=MORE, damage=damage.replace("READERS", ", h: {use: fill.hold, in: $recording}")
    )
    assert "to 'recording', which must not see it" in message


class Wired(NamedTuple):
    """A random graph: for each node its kind and what feeds it, as (node, output) pairs."""

    kinds: tuple[str, ...]
    feeds: tuple[tuple[tuple[int, str], ...], ...]

    def text(self) -> str:
        """Return the graph as a file."""
        uses = {"read": "read.number", "hold": "fill.hold", "two": "fill.two", "cut": "noise.add"}
        lines = ["nodes:", "  text: {use: text.count}"]
        for number, (kind, feeds) in enumerate(zip(self.kinds, self.feeds, strict=True)):
            if kind == "score":
                (estimate, truth) = (f"n{node}.{output}" for node, output in feeds)
                wires = f"{{estimate: {estimate}, truth: {truth}, hidden: text}}"
                lines.append(f"  n{number}: {{use: score.gaps, in: {wires}}}")
                continue
            ports = dict(zip(("recording", "reference"), feeds, strict=False))
            wires = ", ".join(f"{port}: n{node}.{output}" for port, (node, output) in ports.items())
            lines.append(f"  n{number}: {{use: {uses[kind]}, in: {{{wires}}}}}")
        return "\n".join(lines)

    def damaging(self, node: int) -> Iterator[int]:
        """Yield the first damaging nodes on all ways back that begin with a node."""
        if self.kinds[node] == "cut":
            yield node
        else:
            for source, _ in self.feeds[node]:
                yield from self.damaging(source)

    def ways(self, node: int) -> Iterator[tuple[tuple[int, str], ...]]:
        """Yield every way, as wires, that ends at a node."""
        yield ()
        for source, output in self.feeds[node]:
            for way in self.ways(source):
                yield (*way, (source, output))

    def leaks(self) -> bool:
        """Return whether the last node, a score, sees what it is scored against."""
        estimate, truth = self.feeds[-1]
        for hiding in self.damaging(truth[0]):
            upstream = {source for way in self.ways(hiding) for source, _ in way}
            for way in self.ways(estimate[0]):
                wires = (*way, estimate)
                begins = wires[0][0] in upstream or wires[0] == (hiding, "truth")
                if begins and (hiding, "noisy") not in wires:
                    return True
        return False


@st.composite
def graphs(draw: st.DrawFn) -> Wired:
    kinds = ["read"]
    feeds: list[tuple[tuple[int, str], ...]] = [()]
    wire: list[tuple[int, str]] = [(0, "output")]
    truths: list[tuple[int, str]] = []
    for number in range(1, draw(st.integers(3, 7))):
        kind = draw(st.sampled_from(["read", "hold", "two", "cut", "cut"]))
        plain = st.sampled_from(wire)
        count = {"read": 0, "two": 2}.get(kind, 1)
        kinds.append(kind)
        feeds.append(tuple(draw(plain) for _ in range(count)))
        wire.append((number, "noisy" if kind == "cut" else "output"))
        truths += [(number, "truth")] if kind == "cut" else []
    score = (draw(st.sampled_from(wire)), draw(st.sampled_from([*wire, *truths])))
    return Wired((*kinds, "score"), (*feeds, score))


@settings(
    max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(wired=graphs())
def test_leaks_of_random_graphs_are_those_of_every_way(
    graph_of: Callable[..., Graph], wired: Wired
) -> None:
    if wired.leaks():
        with pytest.raises(GraphError, match="is scored against what"):
            graph_of(wired.text(), more=(*MORE, count))
    else:
        assert graph_of(wired.text(), more=(*MORE, count))
