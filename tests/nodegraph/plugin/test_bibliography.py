from __future__ import annotations

import pytest

from nodegraph.plugin.bibliography import bibtex_of, references

ONE = "@book{one2001, author={A. One}, title={First things}, publisher={P}, year={2001}}"
TWO = "@book{two2002, author={B. Two}, title={Second things}, publisher={P}, year={2002}}"


def test_entries_come_in_the_order_of_the_keys() -> None:
    texts = references([f"{ONE}\n{TWO}"], ["two2002", "one2001", "two2002"])
    assert list(texts) == ["two2002", "one2001"]
    assert "Second things" in texts["two2002"]
    assert "First things" in texts["one2001"]


def test_an_unknown_key_is_its_own_text() -> None:
    assert references([ONE], ["nobody"]) == {"nobody": "nobody (no BibTeX entry is installed)"}
    assert references([], []) == {}


def test_the_first_plugin_with_a_key_counts() -> None:
    other = ONE.replace("First", "Other")
    assert "First things" in references([ONE, other], ["one2001"])["one2001"]


def test_bibtex_that_cannot_be_read_is_left_out_with_a_warning() -> None:
    with pytest.warns(UserWarning, match="BibTeX"):
        texts = references(["@book{broken", TWO], ["two2002"])
    assert "Second things" in texts["two2002"]


def test_the_source_of_entries_is_sorted_and_can_be_read_again() -> None:
    source = bibtex_of([f"{TWO}\n{ONE}"], ["two2002", "one2001", "nobody", "two2002"])
    assert source.index("one2001") < source.index("two2002")
    assert source.count("@book") == 2
    assert references([source], ["two2002"]) == references([TWO], ["two2002"])
    assert bibtex_of([ONE], ["nobody"]) == ""


def test_escapes_are_the_characters_that_they_stand_for() -> None:
    escaped = (
        r"@book{both2003, author={M. M{\"u}ller}, title={Q \& A\_1}, publisher={P}, year=2003}"
    )
    assert "Müller. Q & A_1." in references([escaped], ["both2003"])["both2003"]
