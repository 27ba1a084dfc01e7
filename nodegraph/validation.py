"""Where data do not have the form they should have, in words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import ValidationError

_OTHERS = re.compile(" or instance of .*")


def first_misfit(error: ValidationError, data: Any, at: tuple[int | str, ...] = ()) -> str:
    """Return which key of data is first of another form, and how: ``steps.3.use: field required``.

    Parameters
    ----------
    error
        What pydantic found.
    data
        What it was found in.
    at
        The keys to the data, where they are a part of other data.
    """
    first = error.errors(include_url=False)[0]
    said = _OTHERS.sub("", first["msg"])
    place = ".".join([*map(str, at), *_keys(data, first["loc"])])
    return f"{place or 'all of it'}: {said[:1].lower()}{said[1:]}"


def _keys(data: Any, location: Iterable[int | str]) -> list[str]:
    """Return the keys to a place, without what pydantic calls the alternatives of a type."""
    keys: list[str] = []
    for key in location:
        if isinstance(data, Mapping):
            keys.append(str(key))
            data = data.get(key)
        elif isinstance(data, list) and isinstance(key, int) and key < len(data):
            keys.append(str(key))
            data = data[key]
    return keys
