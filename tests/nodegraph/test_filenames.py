"""Names of files differ wherever what they stand for does, on any disk."""

from __future__ import annotations

from pathlib import Path

from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from nodegraph.filenames import file_stem, fold, portable_name, portable_paths
from tests.nodegraph.cli.portable import check_portable
from tests.texts import any_text

LETTERS = st.sampled_from("aAbB1_-. /<?\u00e9\u0301\u00c9\u00df\u6f22\ud800\0")
TEXTS = st.one_of(any_text(min_size=1), st.text(LETTERS, min_size=1, max_size=5))
LABELS = st.one_of(TEXTS, st.integers(), st.floats(allow_nan=False))
PATHS = st.lists(TEXTS, min_size=1, max_size=4).map(
    lambda parts: "/".join(part.replace("/", "") or "x" for part in parts)
)
ANY_DURATION = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
"""No verdict of a test depends on how long it takes."""


@ANY_DURATION
@given(st.lists(LABELS, unique=True), st.lists(LABELS, unique=True, min_size=1, max_size=3))
@example(["a", "A", "a_b", "a-b", "<5", ">5", 5, "5", "p" * 60], ["x", "x_y-z", "q" * 60])
@example(["a b", file_stem([["a b"]])], ["x"])
def test_combinations_have_names_of_their_own(first: list[object], second: list[object]) -> None:
    names = [
        file_stem([["node"], ["x", label], ["y", other]]) for label in first for other in second
    ]
    check_portable(f"{name}.csv" for name in names)
    assert len({fold(name) for name in names}) == len(names)


def test_plain_labels_stand_in_a_name_as_they_are() -> None:
    words: list[list[object]] = [
        ["a_table"],
        ["fill", "lin_ouhyoung"],
        ["actor", "me_2"],
        ["size", -5],
        ["g", 0.25],
    ]
    assert file_stem(words) == "a-table_fill-lin-ouhyoung_actor-me-2_size--5_g-0.25"


@ANY_DURATION
@given(st.lists(PATHS, unique=True))
@example(["a", "a/b", "A", "A/b", "a?", "a?/b", "con", "CON.x/y", "n" * 300, "m/" * 200 + "m"])
def test_paths_have_names_of_their_own(paths: list[str]) -> None:
    portable = portable_paths(paths)
    assert list(portable) == paths
    check_portable(portable.values())


@ANY_DURATION
@given(TEXTS)
def test_any_text_gives_a_name(text: str) -> None:
    check_portable([portable_name(text)])


def test_plain_names_stay_as_they_are() -> None:
    for name in ("recording.c3d", "take 1 (best).tar.gz", "caf\u00e9", "Makefile", "a_b-c", "0"):
        assert portable_name(name) == name
    here = [path.name for path in Path(__file__).parent.iterdir() if path.name[0] not in "._"]
    assert portable_paths(here) == {name: name for name in here}
