"""The decorator that makes a function a node, and what the function's signature declares."""

from __future__ import annotations

import inspect
import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cached_property
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    TypedDict,
    TypeVar,
    Union,
    Unpack,
    get_args,
    get_origin,
    get_type_hints,
    overload,
)

from nodegraph.errors import NodeError, nearest
from nodegraph.node.declaration import (
    UNDECLARED,
    Adapted,
    Declaration,
    Ends,
    LookAhead,
    Synthetic,
    Undeclared,
)
from nodegraph.node.live_form import FrameForm, LiveForm, RunningForm, StateForm, WindowForm
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
from nodegraph.node.shared import with_shared
from nodegraph.node.values import Value

if TYPE_CHECKING:
    from pydantic import BaseModel

F = TypeVar("F", bound=Callable[..., object])
R = TypeVar("R")
T = TypeVar("T")

_NAME = re.compile(r"[a-z][a-z0-9_]*\.[a-z][a-z0-9_]*")
_ATTRIBUTE = "__nodegraph_node__"
_NO_DEFAULT = inspect.Parameter.empty


class _Declarations(TypedDict, total=False):
    cite: str | tuple[str, ...]
    adapted: Adapted
    lookahead: LookAhead
    ends: Ends
    synthetic: Synthetic
    live: Literal["frame"] | LiveForm | None
    requires: Callable[..., object] | None
    deprecated: str
    timeout: float | None


@overload
def node(name: str, **declared: Unpack[_Declarations]) -> Callable[[F], F]: ...


@overload
def node(
    name: str, *, shares: object, **declared: Unpack[_Declarations]
) -> Callable[[Callable[..., R]], Callable[..., R]]: ...


def node(
    name: str,
    *,
    cite: str | tuple[str, ...] = "none",
    adapted: Adapted = "",
    lookahead: LookAhead = UNDECLARED,
    ends: Ends = None,
    synthetic: Synthetic = False,
    live: Literal["frame"] | LiveForm | None = None,
    requires: Callable[..., object] | None = None,
    deprecated: str = "",
    timeout: float | None = None,
    shares: object = None,
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a function a node; it stays callable as it is.

    Positional arguments are input ports, keyword-only arguments are settings, the return
    annotation is the output: one type, or a NamedTuple (or frozen dataclass) of several.

    Parameters
    ----------
    name
        ``family.method``, in lower case.
    cite
        Keys of BibTeX entries that the plugin ships, or ``"none"``.
    adapted
        What the method is taken from and what differs: ``"from Burke and Lasenby 2016: ..."``;
        or a function of the settings that returns it. Without it, or with an empty text, a method
        that declares its look-ahead is as published.
    lookahead
        How many frames after a frame its result depends on: a number, None for the whole take or
        any number that the settings do not bound, or a function of the settings that returns one
        of these: ``lookahead=lambda settings: settings["order"] // 2``. Omitted by nodes that
        are not methods: readers, scores, figures.
    ends
        For a family that bridges gaps: whether the result is continuous with the samples at both
        ends of a gap; or a function of the settings that returns it.
    synthetic
        For a node without inputs: whether its data are made by a generator, not recorded; or a
        function of the settings that returns it. What is found on such data holds for more of them.
    live
        How the node computes frame by frame, so that a stream gives what the whole take gives:
        ``"frame"`` if its function, called with one frame, does; a `WindowForm` or a `StateForm`;
        a `RunningForm` for a node that computes one value of a whole take.
        Omitted by nodes that need the whole take.
    requires
        A quick function that raises a ValueError if settings do not fit the inputs, as the node
        then does; its arguments are those ports and settings that it needs, by their names.
        ``nodegraph check`` calls it on recordings, which are read for that.
    deprecated
        What to use instead, for a node that another replaces: ``"use fill.new"``. The node works
        as before; graphs that use it get a notice, and ``family.*`` leaves it out.
    timeout
        Seconds after which a call has failed, for a node that may never return.
    shares
        A frozen dataclass of ports and settings that several nodes have, with their documentation
        under "Attributes"; or a value of it, whose fields are the defaults. The function takes it
        in an argument that is annotated with it; the node, and whoever calls it, has the fields
        in place of that argument: those for keywords only as settings, the others as ports. What
        it says under "Returns" and "Raises" is said of the node, but for entries of its own.

    Raises
    ------
    NodeError
        If the name is not of that form, or no argument takes what is shared. The rest of the
        signature and what is declared are checked when the node is first used.

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

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        if shares is not None:
            function = with_shared(name, function, shares)
        cited = tuple(key for key in keys if key != "none")
        declaration = Declaration(adapted, lookahead, ends, synthetic)
        described = Node(
            name,
            function,
            cited,
            declaration=declaration,
            live=FrameForm() if live == "frame" else live,
            requires=requires,
            deprecated=deprecated,
            timeout=timeout,
        )
        setattr(function, _ATTRIBUTE, described)
        return function

    return decorate


def node_of(function: object) -> Node | None:
    """Return the node that a decorated function is, or None for any other object."""
    node = getattr(function, _ATTRIBUTE, None)
    return node if isinstance(node, Node) else None


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of a node.

    Attributes
    ----------
    name : str
    annotation : object
        Its type with bounds and choices, as pydantic reads it.
    default : object
        `inspect.Parameter.empty` for a setting that is required.
    unit : str
    is_file : bool
        Whether it names a file to read.
    deprecated : str
        What to use instead, for a setting that another replaces.
    names : ColumnOf, LabelOf or None
        The port of whose tables it names columns, or of whose axes a label.
    """

    name: str
    annotation: object
    default: object
    unit: str
    is_file: bool
    deprecated: str = ""
    names: ColumnOf | LabelOf | None = None

    @property
    def required(self) -> bool:
        """Whether a graph must set it."""
        return self.default is _NO_DEFAULT


@dataclass(frozen=True)
class Node:
    """A function with the ports and settings that its signature declares.

    Attributes
    ----------
    name : str
        ``family.method``.
    function : callable
        The function itself, unchanged.
    cite : tuple of str
        Keys of BibTeX entries that its plugin ships.
    declaration : Declaration
        What a fair comparison needs to know of a method.
    live : LiveForm or None
        How it computes frame by frame; None if it needs the whole take.
    requires : callable or None
        Raises a ValueError if settings do not fit the inputs.
    deprecated : str
        What to use instead, for a node that another replaces.
    timeout : float or None
        Seconds that a call may take.
    """

    name: str
    function: Callable[..., Any]
    cite: tuple[str, ...]
    declaration: Declaration = field(default=Declaration(), kw_only=True)
    live: LiveForm | None = field(default=None, kw_only=True)
    requires: Callable[..., object] | None = field(default=None, kw_only=True)
    deprecated: str = field(default="", kw_only=True)
    timeout: float | None = field(default=None, kw_only=True)

    @property
    def family(self) -> str:
        """The part before the point."""
        return self.name.partition(".")[0]

    @property
    def method(self) -> str:
        """The part after the point, the label among alternatives."""
        return self.name.partition(".")[2]

    @cached_property
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
            _input_port(self.name, argument, self._hints[argument.name])
            for argument in self._arguments
            if argument.kind is not argument.KEYWORD_ONLY
        )

    @cached_property
    def outputs(self) -> tuple[Port, ...]:
        """Output ports; the first is the one most often used."""
        hint = self._hints["return"]
        if not self.splits:
            return (_output_port(self.name, "output", hint),)
        record = _plain_type(hint)
        hints = get_type_hints(record, include_extras=True)
        return tuple(_output_port(self.name, name, hints[name]) for name in _field_names(record))

    @cached_property
    def damages(self) -> bool:
        """Whether it damages its input and also returns the truth; it may take the truth."""
        return any(port.truth for port in self.outputs)

    @cached_property
    def settings(self) -> Mapping[str, Setting]:
        """Settings by name."""
        return {
            argument.name: _setting(argument, self._hints[argument.name])
            for argument in self._arguments
            if argument.kind is argument.KEYWORD_ONLY
        }

    @cached_property
    def model(self) -> type[BaseModel]:
        """The pydantic model that validates the settings, without silent conversions."""
        from pydantic import ConfigDict, create_model

        definitions: dict[str, Any] = {
            setting.name: (setting.annotation, ... if setting.required else setting.default)
            for setting in self.settings.values()
        }
        config = ConfigDict(
            extra="forbid", strict=True, arbitrary_types_allowed=True, protected_namespaces=()
        )
        with warnings.catch_warnings():
            # a setting may have the name of one of pydantic's own methods
            warnings.simplefilter("ignore", UserWarning)
            return create_model(self.name, __config__=config, **definitions)

    @cached_property
    def splits(self) -> bool:
        """Whether the function returns several outputs in one record."""
        returned = _plain_type(self._hints["return"])
        if not isinstance(returned, type) or issubclass(returned, Value):
            return False
        return is_dataclass(returned) or (
            issubclass(returned, tuple) and hasattr(returned, "_fields")
        )

    def check(self) -> Node:
        """Return the node itself, or raise `NodeError` if its signature is not that of a node."""
        if not self.outputs:
            raise NodeError(f"{self.name}: the record that it returns has no field")
        for name in (*(port.name for port in self.inputs), *self.settings):
            if name.startswith("_"):
                raise NodeError(f"{self.name}: {name!r} begins with an underscore; users write it")
        unknown = [name for name in self.streams if self.port(name) is None]
        if unknown or (self.live is not None and not self.inputs):
            ports = ", ".join(port.name for port in self.inputs) or "none"
            raise NodeError(
                f"{self.name}: its live form streams {', '.join(unknown) or 'its first port'}; "
                f"its ports are {ports}"
            )
        if isinstance(self.live, RunningForm) and self.splits:
            raise NodeError(f"{self.name}: has several outputs; a RunningForm is for one")
        self._check_requires()
        if self.timeout is not None and not 0 < self.timeout < math.inf:
            raise NodeError(f"{self.name}: timeout is {self.timeout!r}; it must be seconds above 0")
        defaults = self.defaults
        if len(defaults) == len(self.settings):
            self.lookahead(defaults)
            self.live_lookahead(defaults)
            self.meets_ends(defaults)
            self.adapted_from(defaults)
        return self

    def _check_requires(self) -> None:
        if self.requires is None:
            return
        known = [*(port.name for port in self.inputs if not port.across), *self.settings]
        for name in inspect.signature(self.requires).parameters:
            if name not in known:
                raise NodeError(
                    f"{self.name}: the function given as requires takes {name!r}, which is neither "
                    f"a port of one value nor a setting; {nearest(name, known)}"
                )

    def limit(self, timeout: float | None) -> float | None:
        """Return the seconds that a call may take in a run with that limit: the shorter of both."""
        if self.timeout is None or timeout is None:
            return self.timeout if timeout is None else timeout
        return min(self.timeout, timeout)

    @property
    def defaults(self) -> dict[str, object]:
        """The defaults of those settings that have one."""
        return {
            setting.name: setting.default
            for setting in self.settings.values()
            if not setting.required
        }

    def lookahead(self, settings: Mapping[str, object]) -> int | Undeclared | None:
        """Return how many frames ahead the result depends on; None if nothing bounds them.

        Parameters
        ----------
        settings
            All of them, defaults included.

        Raises
        ------
        NodeError
            If the declared function fails, or what is declared is of another kind.
        """
        return self._frames("lookahead", self.declaration.lookahead, settings)

    def live_lookahead(self, settings: Mapping[str, object]) -> int | None:
        """Return how many frames later its live form gives a frame; None if nothing bounds them.

        See `lookahead`.
        """
        declared: Any = UNDECLARED
        if isinstance(self.live, WindowForm):
            declared = self._frames("after", self.live.after, settings)
        elif isinstance(self.live, StateForm):
            declared = self._frames("lookahead", self.live.lookahead, settings)
        elif isinstance(self.live, RunningForm):
            declared = 0
        if declared is UNDECLARED:
            declared = self.lookahead(settings)
        return 0 if declared is UNDECLARED else declared

    @cached_property
    def streams(self) -> tuple[str, ...]:
        """The ports at which its live form takes frames; none if it has no live form."""
        if self.live is None:
            return ()
        return self.live.streams or tuple(port.name for port in self.inputs[:1])

    def _frames(
        self, what: str, value: object, settings: Mapping[str, object]
    ) -> int | Undeclared | None:
        declared = self._declared(what, value, settings)
        if declared is None or declared is UNDECLARED:
            return declared
        if isinstance(declared, int) and not isinstance(declared, bool) and declared >= 0:
            return declared
        raise NodeError(
            f"{self.name}: {what} is {declared!r}; it must be a number of frames, or None for "
            "the whole take"
        )

    def meets_ends(self, settings: Mapping[str, object]) -> bool | None:
        """Return whether the result meets both ends of a gap; None if that is not declared.

        See `lookahead`.
        """
        declared = self._declared("ends", self.declaration.ends, settings)
        if declared is None or isinstance(declared, bool):
            return declared
        raise NodeError(f"{self.name}: ends is {declared!r}; it must be True or False")

    def adapted_from(self, settings: Mapping[str, object]) -> str:
        """Return what the method is taken from and what differs; empty if it is as published.

        See `lookahead`.
        """
        declared = self._declared("adapted", self.declaration.adapted, settings)
        if isinstance(declared, str):
            return declared
        raise NodeError(f"{self.name}: adapted is {declared!r}; it must be a text")

    def is_synthetic(self, settings: Mapping[str, object]) -> bool:
        """Return whether the data that the node gives are made, not recorded.

        See `lookahead`.
        """
        declared = self._declared("synthetic", self.declaration.synthetic, settings)
        if isinstance(declared, bool):
            return declared
        raise NodeError(f"{self.name}: synthetic is {declared!r}; it must be True or False")

    def _declared(self, what: str, value: object, settings: Mapping[str, object]) -> object:
        if not callable(value):
            return value
        try:
            return value(settings)
        except Exception as error:
            raise NodeError(
                f"{self.name}: the function given as {what} failed: {type(error).__name__}: {error}"
            ) from error

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
            if argument.kind in (argument.VAR_POSITIONAL, argument.VAR_KEYWORD):
                raise NodeError(
                    f"{self.name}: *{argument.name} is neither a port nor a setting; name each one"
                )
            if argument.kind is argument.POSITIONAL_ONLY:
                raise NodeError(
                    f"{self.name}: {argument.name!r} must be allowed by keyword; remove the '/'"
                )
        return arguments

    @cached_property
    def _hints(self) -> dict[str, object]:
        try:
            hints = get_type_hints(self.function, include_extras=True)
        except (NameError, AttributeError, TypeError) as error:
            raise NodeError(f"{self.name}: an annotation cannot be read: {error}") from error
        names = [*(argument.name for argument in self._arguments), "return"]
        missing = [name for name in names if name not in hints]
        if missing:
            raise NodeError(f"{self.name}: {', '.join(missing)} has no annotation")
        return hints


def _input_port(node_name: str, argument: inspect.Parameter, hint: object) -> Port:
    # None and Truth may stand in either order: Truth[T | None] and Truth[T] | None
    inner, is_optional = _without_none(hint)
    truth = _has_mark(hint, TruthMark) or _has_mark(inner, TruthMark)
    inner, is_optional_inside = _without_none(_plain_type(inner))
    optional = is_optional or is_optional_inside
    across = get_origin(inner) is Across
    if across:
        inner = get_args(inner)[0]
        truth = truth or _has_mark(inner, TruthMark)
    kind = _single_type(node_name, f"port {argument.name!r}", inner)
    if argument.default is not _NO_DEFAULT and argument.default is not None:
        form = f"*, {argument.name}: {kind.__name__} = {argument.default!r}"
        raise NodeError(f"{node_name}: {argument.name!r} is a setting: write it after '*', {form}")
    if (argument.default is not _NO_DEFAULT) != optional:
        form = f"{argument.name}: {kind.__name__} | None = None"
        raise NodeError(f"{node_name}: an optional port is written {form}")
    return Port(argument.name, kind, truth, across, optional)


def _output_port(node_name: str, name: str, hint: object) -> Port:
    kind = _single_type(node_name, f"output {name!r}", hint)
    columns = next((mark.names for mark in _marks(hint, Columns)), ())
    return Port(name, kind, truth=_has_mark(hint, TruthMark), columns=columns)


def _single_type(node_name: str, what: str, hint: object) -> type:
    kind = _plain_type(hint)
    if isinstance(kind, type) and kind is not Any:
        return kind
    raise NodeError(f"{node_name}: {what} needs one type, not {kind}")


def _setting(argument: inspect.Parameter, hint: object) -> Setting:
    inner, _ = _without_none(hint)

    def first_mark(kind: type[T]) -> T | None:
        return next((mark for each in (hint, inner) for mark in _marks(each, kind)), None)

    unit = first_mark(Unit)
    deprecated = first_mark(Deprecated)
    return Setting(
        name=argument.name,
        annotation=hint,
        default=argument.default,
        unit=unit.name if unit else "",
        is_file=first_mark(FileMark) is not None,
        deprecated=deprecated.instead if deprecated else "",
        names=first_mark(ColumnOf) or first_mark(LabelOf),
    )


def _field_names(record: type) -> tuple[str, ...]:
    names: tuple[str, ...] | None = getattr(record, "_fields", None)
    return names if names is not None else tuple(field.name for field in fields(record))


def _plain_type(hint: object) -> Any:
    """Return an annotation without its marks."""
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint


def _marks(hint: Any, kind: type[T]) -> Iterator[T]:
    """Yield the marks of a kind in ``Annotated[...]``."""
    metadata = hint.__metadata__ if get_origin(hint) is Annotated else ()
    return (mark for mark in metadata if isinstance(mark, kind))


def _has_mark(hint: object, kind: type) -> bool:
    return any(_marks(hint, kind))


def _without_none(hint: object) -> tuple[object, bool]:
    """Return ``T`` and True for ``T | None``, any other annotation and False."""
    if get_origin(hint) not in (Union, UnionType):
        return hint, False
    types = [each for each in get_args(hint) if each is not NoneType]
    return (types[0] if len(types) == 1 else hint), len(types) < len(get_args(hint))
