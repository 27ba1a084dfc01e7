from __future__ import annotations

import pytest
from pydantic import BaseModel, ConfigDict, ValidationError

from nodegraph.validation_errors import first_error


class Inner(BaseModel):
    model_config = ConfigDict(strict=True)

    size: int | list[str]


class Outer(BaseModel):
    parts: dict[str, list[Inner]]


@pytest.mark.parametrize(
    ("data", "text"),
    [
        ({"parts": {"a": [{"size": 1}, {"size": 2.5}]}}, "parts.a.1.size: input should be a valid"),
        ({"parts": {"a": [{"size": ["x", 3]}]}}, "parts.a.0.size: input should be a valid integer"),
        ({"parts": {"a": [{}]}}, "parts.a.0.size: field required"),
        ({}, "parts: field required"),
        ([], "all of it: input should be a valid dictionary"),
    ],
)
def test_the_first_key_that_does_not_fit_is_named(data: object, text: str) -> None:
    with pytest.raises(ValidationError) as caught:
        Outer.model_validate(data)
    message = first_error(caught.value, data)
    assert message.startswith(text)
    assert "instance of" not in message


def test_a_part_is_named_by_its_place_in_the_whole() -> None:
    with pytest.raises(ValidationError) as caught:
        Inner.model_validate({})
    assert first_error(caught.value, {}, ("steps", 3)) == "steps.3.size: field required"
