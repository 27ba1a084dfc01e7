"""A function's signature, piece by piece: which argument is a port, which a setting."""

from __future__ import annotations

import inspect
from dataclasses import dataclass, fields, is_dataclass
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

from nodegraph.errors import NodeError
from nodegraph.ports import (
    Across,
    ColumnOf,
    Columns,
    Deprecated,
    FileMark,
    LabelOf,
    Port,
    TruthMark,
    Unit,
)
from nodegraph.values import Value

_REQUIRED = inspect.Parameter.empty


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of a node.

    Attributes
    ----------
    name : str
    annotation : Any
        Its type with bounds and choices, as pydantic reads it.
    default : Any
        `inspect.Parameter.empty` when it must be given.
    unit : str
    is_file : bool
        Whether it names a file to read.
    deprecated : str
        What to use instead; empty unless something replaces it.
    names : ColumnOf, LabelOf or None
        Of which port's tables it names columns, or of which port's axes a label.
    """

    name: str
    annotation: Any
    default: Any
    unit: str
    is_file: bool
    deprecated: str = ""
    names: ColumnOf | LabelOf | None = None

    @property
    def required(self) -> bool:
        """Whether a graph must give it."""
        return self.default is _REQUIRED


def check_argument(name: str, argument: inspect.Parameter) -> None:
    """Refuse an argument that is neither a port nor a setting."""
    if argument.kind in (argument.VAR_POSITIONAL, argument.VAR_KEYWORD):
        raise NodeError(f"{name}: *{argument.name} is neither a port nor a setting; name each one")
    if argument.kind is argument.POSITIONAL_ONLY:
        raise NodeError(f"{name}: {argument.name!r} must take its name; leave out the '/'")


def input_port(node_name: str, argument: inspect.Parameter, hint: Any) -> Port:
    """Return the port that a positional argument declares."""
    inner, optional = _without_none(hint)
    truth = _has_mark(hint, TruthMark) or _has_mark(inner, TruthMark)
    inner, also = _without_none(plain_type(inner))
    across = get_origin(inner) is Across
    if across:
        inner = get_args(inner)[0]
        truth = truth or _has_mark(inner, TruthMark)
    held = _one_type(node_name, f"port {argument.name!r}", plain_type(inner))
    if (argument.default is not _REQUIRED) != (optional or also):
        form = f"{argument.name}: {held.__name__} | None = None"
        raise NodeError(f"{node_name}: a port that may be left open is written {form}")
    return Port(argument.name, held, truth, across, optional or also)


def output_ports(node_name: str, hint: Any) -> tuple[Port, ...]:
    """Return the ports that a return annotation declares."""
    returned = plain_type(hint)
    if is_record(returned):
        hints = get_type_hints(returned, include_extras=True)
        return tuple(_output_port(node_name, one, hints[one]) for one in _field_names(returned))
    return (_output_port(node_name, "output", hint),)


def _output_port(node_name: str, name: str, hint: Any) -> Port:
    held = _one_type(node_name, f"output {name!r}", plain_type(hint))
    columns = next((one.names for one in _marks(hint) if isinstance(one, Columns)), ())
    return Port(name, held, truth=_has_mark(hint, TruthMark), columns=columns)


def _one_type(node_name: str, what: str, hint: Any) -> type:
    if isinstance(hint, type) and hint is not Any:
        return hint
    raise NodeError(f"{node_name}: {what} needs one type, not {hint}")


def read_setting(argument: inspect.Parameter, hint: Any) -> Setting:
    """Return the setting that a keyword-only argument declares."""
    units = [mark.name for mark in _marks(hint) if isinstance(mark, Unit)]
    inner, _ = _without_none(hint)
    is_file = _has_mark(hint, FileMark) or _has_mark(inner, FileMark)
    marks = (*_marks(hint), *_marks(inner))
    instead = next((one.instead for one in marks if isinstance(one, Deprecated)), "")
    names = next((one for one in marks if isinstance(one, ColumnOf | LabelOf)), None)
    unit = units[0] if units else ""
    return Setting(argument.name, hint, argument.default, unit, is_file, instead, names)


def is_record(hint: Any) -> bool:
    """Whether an annotation is a record whose fields are ports, not one value."""
    if not isinstance(hint, type) or issubclass(hint, Value):
        return False
    return is_dataclass(hint) or (issubclass(hint, tuple) and hasattr(hint, "_fields"))


def _field_names(record: type) -> tuple[str, ...]:
    named: tuple[str, ...] | None = getattr(record, "_fields", None)
    return named if named is not None else tuple(field.name for field in fields(record))


def plain_type(hint: Any) -> Any:
    """Return an annotation without its marks."""
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint


def _marks(hint: Any) -> tuple[Any, ...]:
    return tuple(hint.__metadata__) if get_origin(hint) is Annotated else ()


def _has_mark(hint: Any, kind: type) -> bool:
    return any(isinstance(mark, kind) for mark in _marks(hint))


def _without_none(hint: Any) -> tuple[Any, bool]:
    if get_origin(hint) not in (Union, UnionType):
        return hint, False
    kept = [one for one in get_args(hint) if one is not NoneType]
    return (kept[0] if len(kept) == 1 else hint), len(kept) < len(get_args(hint))
