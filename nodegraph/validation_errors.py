"""Documents checked by pydantic, and its errors as text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import TypeAdapter, ValidationError

_OTHER_TYPES = re.compile(" or (an )?instance of .*")


@cache
def adapter_of(kind: type) -> TypeAdapter[Any]:
    """Return what reads and writes documents of a type."""
    from pydantic import TypeAdapter

    return TypeAdapter(kind)


def first_error(error: ValidationError, data: object, at: tuple[int | str, ...] = ()) -> str:
    """Return the first error of a document with its place: ``steps.3.use: field required``.

    Parameters
    ----------
    error
        The errors of the document.
    data
        The document.
    at
        The keys to `data`, where it is part of another document.
    """
    first = error.errors(include_url=False)[0]
    message = _OTHER_TYPES.sub("", first["msg"])
    place = ".".join([*map(str, at), *_keys(data, first["loc"])])
    return f"{place or 'all of it'}: {message[:1].lower()}{message[1:]}"


def _keys(data: object, location: Iterable[int | str]) -> list[str]:
    """Return the keys to a place, without pydantic's names of the members of a union."""
    keys: list[str] = []
    for key in location:
        if isinstance(data, Mapping):
            keys.append(str(key))
            data = data.get(key)
        elif isinstance(data, list) and isinstance(key, int) and key < len(data):
            keys.append(str(key))
            data = data[key]
    return keys
