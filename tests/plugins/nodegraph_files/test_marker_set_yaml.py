from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_files import marker_set_text, read_marker_set_yaml
from nodegraph_files.marker_set import marker_set_of, plain_marker_set
from nodegraph_mocap import MarkerSet

Write = Callable[[str], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def written(text: str) -> Path:
        path = tmp_path / "markers.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return written


def test_every_part_is_read(write: Write) -> None:
    text = "markers: [a, b, c]\npairs:  # left, right\n  - [a, b]\nmidline: [c]\nstable: [c]\n"
    assert read_marker_set_yaml(write(text + "edges: [[a, c], [b, c]]\n")) == MarkerSet(
        markers=("a", "b", "c"),
        pairs=(("a", "b"),),
        midline=("c",),
        stable=("c",),
        edges=(("a", "c"), ("b", "c")),
    )


def test_names_stay_the_texts_that_they_are(write: Write) -> None:
    names = ("no", "1e3", "0x1", "007", "null", "~", "yes", "1_0", "2001-01-01", "12:30:00")
    assert read_marker_set_yaml(write(f"markers: [{', '.join(names)}]\n")).markers == names


def test_a_part_may_be_empty(write: Write) -> None:
    assert read_marker_set_yaml(write("markers: [a]\nmidline:\nedges: []\n")) == MarkerSet(
        markers=("a",)
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must be a mapping with 'markers', and may have pairs, midline, stable, edges"),
        ("[a, b]", "must be a mapping"),
        ("pairs: []", "must be a mapping with 'markers'"),
        ("markers: [a]\npears: []", "unknown key 'pears'; there is markers, pairs, midline"),
        ("markers: [a]\nstable: [a]\nmarkers: [b]", "line 3: 'markers' again, after line 1"),
        ("markers: a", "'markers' must be a list"),
        ("markers: {a: b}", "'markers' must be a list"),
        ("markers: [[a]]", "'markers' must be a list of names, not"),
        ("markers: ['']", "'markers' must be a list of names, not ''"),
        ("markers: [a, a]", "listed twice: a"),
        ("markers: [a]\nmidline: [b]", "midline names unknown markers: b"),
        ("markers: [a, b]\npairs: [a, b]", "'pairs' must be a list of two names each, not 'a'"),
        ("markers: [a, b]\nedges: [[a, b, a]]", "'edges' must be a list of two names each"),
        ("markers: [a, b]\npairs: [[a, [b]]]", "'pairs' must be a list of two names each"),
        ("markers: [a", "line 1"),
        ("? [a]\n: b", ""),
        ("markers: [a]\n---\nmarkers: [b]", "single document"),
        ("[" * 200, "nested more than 100 deep"),
        ("[" * 100_000, "nest"),
        ("markers: &x [*x]", "recursive"),
    ],
)
def test_what_is_no_marker_set_is_refused(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"(?s)markers\.yaml: not a marker set: .*{message}"):
        read_marker_set_yaml(write(text))


def test_aliases_cannot_grow_beyond_bounds(write: Write) -> None:
    lines = ["- &a0 [a, b]", *(f"- &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 30))]
    with pytest.raises(ValueError, match="must be a list of two names") as refused:
        read_marker_set_yaml(write("markers: [a, b]\npairs:\n" + "\n".join(lines)))
    assert len(str(refused.value)) < 1000


@st.composite
def marker_sets(draw: st.DrawFn) -> MarkerSet:
    texts = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=8)
    names = draw(st.lists(texts, min_size=1, max_size=6, unique=True))
    some = st.lists(st.sampled_from(names), max_size=4).map(tuple)
    couples = st.lists(st.tuples(*[st.sampled_from(names)] * 2), max_size=4).map(tuple)
    return MarkerSet(
        markers=tuple(names),
        pairs=draw(couples),
        midline=draw(some),
        stable=draw(some),
        edges=draw(couples),
    )


@given(marker_sets())
def test_a_text_reads_back_equal(marker_set: MarkerSet) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "markers.yaml"
        path.write_text(marker_set_text(marker_set), encoding="utf-8")
        assert read_marker_set_yaml(path) == marker_set
    assert marker_set_of(plain_marker_set(marker_set)) == marker_set
