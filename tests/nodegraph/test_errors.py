from __future__ import annotations

from functools import partial

import pytest

from nodegraph.errors import (
    GraphError,
    Place,
    Problem,
    Problems,
    closest,
    listed,
    nearest,
    quoted,
)


def test_a_problem_has_place_message_and_hint() -> None:
    problem = Problem(Place("a.yaml", 3, 7), "no node 'x'", "there is: y")
    assert str(problem) == "a.yaml:3:7: no node 'x'\n    there is: y"


def test_a_place_without_a_line_is_the_file() -> None:
    assert str(Problem(Place("--set k"), "wrong")) == "--set k: wrong"


def test_a_message_is_a_line_of_bounded_length_whatever_it_quotes() -> None:
    problem = Problem(Place("a.yaml", 1, 1), "no node 'x\ny'", f"there is: {'z' * 10_000} end")
    first, second = str(problem).split("\n")
    assert first == "a.yaml:1:1: no node 'x y'"
    assert second.startswith("    there is: zzz")
    assert second.endswith("zzz end")
    assert len(second) < 2100


def test_problems_are_reported_once_each_in_reading_order() -> None:
    problems = Problems()
    for line, column in ((2, 9), (1, 5), (2, 1), (1, 5)):
        problems.add(Place("a", line, column), "wrong")
    with pytest.raises(GraphError) as caught:
        problems.raise_any()
    assert [str(problem.place) for problem in caught.value.problems] == ["a:1:5", "a:2:1", "a:2:9"]


def test_the_first_of_thousands_are_shown_and_only_their_hints_are_worked_out() -> None:
    asked = []

    def hint(line: int) -> str:
        asked.append(line)
        return "there is: y"

    problems = Problems()
    for line in range(4000, 0, -1):
        problems.add(Place("a", line, 1), "no node 'x'", partial(hint, line))
    with pytest.raises(GraphError) as caught:
        problems.raise_any()
    lines = str(caught.value).splitlines()
    assert lines[:2] == ["a:1:1: no node 'x'", "    there is: y"]
    assert (len(lines), lines[-1]) == (41, "and 3,980 more; correct these first")
    assert asked == list(range(1, 21))
    assert len(caught.value.problems) == 4000


def test_what_is_quoted_is_short() -> None:
    assert quoted("chin") == "'chin'"
    assert quoted("z" * 10_000) == f"'{'z' * 29} … {'z' * 29}'"


def test_nothing_noted_raises_nothing() -> None:
    problems = Problems()
    problems.raise_any()
    assert not problems


@pytest.mark.parametrize(
    ("name", "known", "hint"),
    [
        ("lenght", ["length", "seed"], "did you mean 'length'? there is: length, seed"),
        ("zzz", ["length"], "there is: length"),
        ("zzz", [], "there is none"),
        (9, [0, 1], "there is: 0, 1"),
    ],
)
def test_nearest_guesses_only_what_is_close(name: object, known: list[object], hint: str) -> None:
    assert nearest(name, known) == hint


def test_nearest_cuts_a_long_list() -> None:
    assert nearest("x", range(30)).endswith("18, 19, and 10 more")


def test_long_lists_of_names_are_cut_and_counted() -> None:
    assert listed(f"m{i}" for i in range(23)).endswith("m19, and 3 more")
    assert listed(range(3), most=3) == "0, 1, 2"
    assert listed(()) == "none"


def test_the_closest_name_is_found_in_any_case() -> None:
    assert closest("NOSE1", ["nose1", "chin"]) == "nose1"
    assert closest("nose1", ["Nose_1", "chin"]) == "Nose_1"
    assert closest("q", ["nose1", "chin"]) == ""


def test_of_many_errors_at_one_place_the_first_are_shown() -> None:
    here, there = Place("graph.yaml", 3, 5), Place("graph.yaml", 9, 1)
    problems = [Problem(here, f"file {number} is not there") for number in range(16)]
    error = GraphError([*problems, Problem(there, "no node is named 'fil'")])
    assert [problem.place for problem in error.first] == [here, here, there]
    assert str(error).endswith("and 14 more; correct these first")
    assert len(error.problems) == 17
