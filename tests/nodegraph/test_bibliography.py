from __future__ import annotations

import pytest

from nodegraph.bibliography import references

ONE = "@article{one, author={Ada Able}, title={A {GREAT} method}, journal={Faces}, year={1998}}"
TWO = "@book{two, author={Bo Best}, title={Gaps}, publisher={House}, year={2001}}"


def test_entries_are_told_as_people_read_them() -> None:
    found = references([ONE, TWO], ["two", "one", "two"])
    assert list(found) == ["two", "one"]
    assert found["one"] == "Ada Able. A GREAT method. Faces, 1998."
    assert found["two"].startswith("Bo Best. Gaps.")


def test_a_key_without_an_entry_stands_for_itself() -> None:
    assert references([ONE], ["three"]) == {"three": "three (no BibTeX entry is installed)"}
    assert references([], []) == {}


def test_two_plugins_may_ship_one_entry() -> None:
    assert references([ONE, ONE.replace("Ada", "Eve")], ["one"])["one"].startswith("Ada Able")


def test_what_cannot_be_read_is_said_and_the_rest_goes_on() -> None:
    with pytest.warns(UserWarning, match="BibTeX of a plugin cannot be read"):
        found = references(["@article{broken", ONE], ["one"])
    assert found["one"].startswith("Ada Able")
