"""A node is a function: its signature says what goes in, what is set and what comes out."""

from __future__ import annotations

import inspect
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cached_property
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from nodegraph.errors import NodeError
from nodegraph.node.ports import (
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
from nodegraph.node.values import Value

if TYPE_CHECKING:
    from pydantic import BaseModel


_signature_REQUIRED = inspect.Parameter.empty


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
        return self.default is _signature_REQUIRED


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
    if (argument.default is not _signature_REQUIRED) != (optional or also):
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


F = TypeVar("F", bound=Callable[..., Any])

_NAME = re.compile(r"[a-z][a-z0-9_]*\.[a-z][a-z0-9_]*")
_ATTRIBUTE = "__nodegraph_node__"
_REQUIRED = inspect.Parameter.empty


@dataclass(frozen=True)
class Node:
    """What a function's signature promises.

    Attributes
    ----------
    name : str
        ``family.method``.
    function : callable
        The function itself, unchanged.
    cite : tuple of str
        Keys of BibTeX entries that its plugin ships.
    deprecated : str
        What to use instead; empty unless something replaces it.
    """

    name: str
    function: Callable[..., Any]
    cite: tuple[str, ...]
    deprecated: str = field(default="", kw_only=True)

    @property
    def family(self) -> str:
        """The part before the point."""
        return self.name.partition(".")[0]

    @property
    def method(self) -> str:
        """The part after the point, the label among alternatives."""
        return self.name.partition(".")[2]

    @property
    def doc(self) -> str:
        """The whole docstring, without its indentation."""
        return inspect.getdoc(self.function) or ""

    @property
    def summary(self) -> str:
        """The docstring's first line."""
        return self.doc.partition("\n")[0]

    @cached_property
    def inputs(self) -> tuple[Port, ...]:
        """Input ports, in the order of the arguments."""
        return tuple(
            input_port(self.name, argument, self._hints[argument.name])
            for argument in self._arguments
            if argument.kind is not argument.KEYWORD_ONLY
        )

    @cached_property
    def outputs(self) -> tuple[Port, ...]:
        """Output ports; the first is the one most often wanted."""
        return output_ports(self.name, self._hints["return"])

    @cached_property
    def settings(self) -> Mapping[str, Setting]:
        """Settings by name."""
        return {
            argument.name: read_setting(argument, self._hints[argument.name])
            for argument in self._arguments
            if argument.kind is argument.KEYWORD_ONLY
        }

    @cached_property
    def model(self) -> type[BaseModel]:
        """The pydantic model that checks the settings; nothing is converted in silence."""
        from pydantic import ConfigDict, create_model

        given: dict[str, Any] = {
            one.name: (one.annotation, ... if one.required else one.default)
            for one in self.settings.values()
        }
        config = ConfigDict(
            extra="forbid", strict=True, arbitrary_types_allowed=True, protected_namespaces=()
        )
        with warnings.catch_warnings():
            # a setting may have any name, also one that pydantic's own methods have
            warnings.simplefilter("ignore", UserWarning)
            return create_model(self.name, __config__=config, **given)

    @cached_property
    def splits(self) -> bool:
        """Whether the function returns several outputs in one record."""
        return is_record(plain_type(self._hints["return"]))

    def check(self) -> Node:
        """Read the whole signature now, so that what it lacks is told now; return the node."""
        if not self.outputs:
            raise NodeError(f"{self.name}: the record that it returns has no field")
        names = [*(port.name for port in self.inputs), *self.settings]
        for name in names:
            if name.startswith("_"):
                raise NodeError(f"{self.name}: {name!r} begins with an underscore; users write it")
        return self

    def port(self, name: str) -> Port | None:
        """Return the input port of that name, if there is one."""
        return next((port for port in self.inputs if port.name == name), None)

    def output(self, name: str) -> Port | None:
        """Return the output port of that name, if there is one."""
        return next((port for port in self.outputs if port.name == name), None)

    @cached_property
    def _arguments(self) -> tuple[inspect.Parameter, ...]:
        arguments = tuple(inspect.signature(self.function).parameters.values())
        for argument in arguments:
            check_argument(self.name, argument)
        return arguments

    @cached_property
    def _hints(self) -> dict[str, Any]:
        try:
            hints = get_type_hints(self.function, include_extras=True)
        except (NameError, AttributeError, TypeError) as error:
            raise NodeError(f"{self.name}: an annotation cannot be read: {error}") from error
        wanted = [argument.name for argument in self._arguments] + ["return"]
        missing = [name for name in wanted if name not in hints]
        if missing:
            raise NodeError(f"{self.name}: {', '.join(missing)} has no annotation")
        return hints


def node(
    name: str, *, cite: str | tuple[str, ...] = "none", deprecated: str = ""
) -> Callable[[F], F]:
    """Make a function a node; it stays callable as it is.

    Positional arguments are input ports, keyword-only arguments are settings, the return
    annotation is the output: one type, or a NamedTuple (or frozen dataclass) of several.

    Parameters
    ----------
    name
        ``family.method``, in lower case.
    cite
        Keys of BibTeX entries that the plugin ships, or ``"none"``.
    deprecated
        For a node that something replaces, what to use instead: ``"use fill.new"``. It works as
        before, whoever uses it is told, and ``family.*`` leaves it out.

    Raises
    ------
    NodeError
        If the name is not of that form. What the signature lacks is told when the node is used.

    Examples
    --------
    >>> from nodegraph_mocap import Trajectories
    >>> @node("fill.nothing")
    ... def nothing(recording: Trajectories) -> Trajectories:
    ...     \"\"\"Leave every gap open.\"\"\"
    ...     return recording
    """
    if not _NAME.fullmatch(name):
        raise NodeError(f"{name!r} is not a node's name; write family.method, in lower case")
    keys = (cite,) if isinstance(cite, str) else tuple(cite)

    def mark(function: F) -> F:
        cited = tuple(key for key in keys if key != "none")
        described = Node(name, function, cited, deprecated=deprecated)
        setattr(function, _ATTRIBUTE, described)
        return function

    return mark


def node_of(function: object) -> Node | None:
    """Return what a decorated function promises, or None for any other object."""
    found = getattr(function, _ATTRIBUTE, None)
    return found if isinstance(found, Node) else None
