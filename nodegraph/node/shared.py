"""Ports and settings that several nodes share, as the fields of a dataclass that documents them."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import MISSING, fields, replace
from functools import cache, partial, wraps
from typing import Any, TypeVar, get_type_hints

from nodegraph.errors import NodeError

R = TypeVar("R")


def section_of(title: str) -> re.Pattern[str]:
    """Return what finds a section of a numpydoc docstring; its text is the first group."""
    return re.compile(rf"^{title}\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)", re.MULTILINE | re.DOTALL)


_SHARED = {"Parameters": "Attributes", "Returns": "Returns", "Raises": "Raises"}
"""Sections of a node's docstring, and those of the dataclass whose entries stand there, too."""
_TYPE = re.compile(r"^(\S.*?) :.*", re.MULTILINE)
_KEYWORD = inspect.Parameter.KEYWORD_ONLY


def with_shared(name: str, function: Callable[..., R], shares: object) -> Callable[..., R]:
    """Return a function with the fields of a dataclass in place of the argument that takes it.

    Signature and docstring have those of the fields where that argument stands: a field that is
    for keywords only is a setting, any other one a port.

    Parameters
    ----------
    name
        The name of the node, for messages.
    function
        One of its arguments is annotated with the dataclass.
    shares
        The dataclass, or a value of it, whose fields are the defaults.

    Raises
    ------
    NodeError
        If no argument is annotated with it, one has the name of a field, or the type of a field is
        not known.
    """
    kind = shares if isinstance(shares, type) else type(shares)
    make = kind if shares is kind else partial(replace, shares)  # type: ignore[type-var]
    declared = inspect.signature(function)
    taken = next((each.name for each in declared.parameters.values() if _is_of(each, kind)), None)
    if taken is None:
        raise NodeError(f"{name}: no argument is annotated with {kind.__name__}, which it shares")
    own = [each for each in declared.parameters.values() if each.name != taken]
    at = list(declared.parameters).index(taken)
    try:
        shared = {each.name: each for each in _arguments(kind, shares)}
        arguments = [*own[:at], *shared.values(), *own[at:]]
        signature = declared.replace(parameters=sorted(arguments, key=lambda each: each.kind))
    except (NameError, ValueError) as error:
        raise NodeError(f"{name}: {error}") from error

    @wraps(function)
    def flat(*inputs: Any, **settings: Any) -> R:
        given = signature.bind(*inputs, **settings).arguments
        values = {each: given.pop(each) for each in shared if each in given}
        return function(**given, **{taken: make(**values)})

    hints = {each.name: each.annotation for each in signature.parameters.values()}
    hints["return"] = signature.return_annotation
    flat.__annotations__ = {
        each: hint for each, hint in hints.items() if hint is not signature.empty
    }
    flat.__signature__ = signature  # type: ignore[attr-defined]
    doc = inspect.getdoc(function)
    flat.__doc__ = doc and _documented(doc, kind, signature.parameters)
    return flat


def _is_of(argument: inspect.Parameter, kind: type) -> bool:
    annotation = argument.annotation
    if isinstance(annotation, str):
        return annotation.rpartition(".")[2] == kind.__name__
    return annotation is kind


def _arguments(kind: type, shares: object) -> Iterator[inspect.Parameter]:
    hints = _hints(kind)
    for each in fields(kind):
        default = each.default if shares is kind else getattr(shares, each.name)
        yield inspect.Parameter(
            each.name,
            _KEYWORD if each.kw_only else inspect.Parameter.POSITIONAL_OR_KEYWORD,
            default=inspect.Parameter.empty if default is MISSING else default,
            annotation=hints[each.name],
        )


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind, include_extras=True)


def _documented(doc: str, kind: type, names: Iterable[str]) -> str:
    """Return a docstring with the entries of a dataclass beside its own, which replace those."""
    text, own = _sections(doc)
    bases = [_own_sections(base) for base in reversed(kind.__mro__)]
    sections = {}
    for title, shared in _SHARED.items():
        entries: dict[str, str] = {}
        for section in (*(base.get(shared, "") for base in bases), own.pop(title, "")):
            entries |= _entries(section)
        order = names if title == "Parameters" else entries
        texts = dict.fromkeys(entries[each] for each in order if each in entries)
        sections[title] = "\n".join(texts)
    sections["Parameters"] = _TYPE.sub(r"\1", sections["Parameters"])
    known = {title: body for title, body in (sections | own).items() if body}
    return "\n\n".join([text, *(f"{each}\n{'-' * len(each)}\n{known[each]}" for each in known)])


@cache
def _own_sections(kind: type) -> dict[str, str]:
    return _sections(inspect.cleandoc(kind.__doc__ or ""))[1]


def _sections(doc: str) -> tuple[str, dict[str, str]]:
    """Return the text of a docstring before its first section, and the sections by title."""
    text, *parts = re.split(r"^(\w[\w ]*)\n-+\n", doc, flags=re.MULTILINE)
    return text.rstrip(), dict(zip(parts[::2], map(str.rstrip, parts[1::2]), strict=True))


def _entries(section: str) -> Iterator[tuple[str, str]]:
    """Yield the names and the text of each entry of a section."""
    for entry in re.split(r"^(?=\S)", section, flags=re.MULTILINE)[1:]:
        for name in entry.partition("\n")[0].partition(" :")[0].split(","):
            yield name.strip(), entry.rstrip()
