"""Who brought something, and what is told where it fails: plugin, hook, why and which line.

What only tells more of a value that is there already (its conclusions, how it differs from
another one) must not cost a run: where that fails it is told, and left out. Without the rest
nobody can go on: it raises `PluginError`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.plugins import reason_of

Function = Callable[..., Any]


class PluginError(NodegraphError):
    """What a plugin brought has failed, or gave nonsense; says which, by which hook, and where."""


class Nonsense(NodegraphError):
    """What a plugin brought gave something of another kind than its hook's specification says."""

    def __init__(self, given: object, due: str) -> None:
        super().__init__(f"it gave {type(given).__name__} where {due} is due")


@dataclass(frozen=True)
class Source:
    """Who brought something.

    Attributes
    ----------
    plugin, hook : str
    package : str
        Whose code it is.
    """

    plugin: str
    hook: str
    package: str

    def failed(self, what: str, error: BaseException) -> str:
        """Return a sentence that tells of a failure: of what, whose, why and at which line.

        Parameters
        ----------
        what
            What the plugin brought, for a reader.
        error
            What it raised.
        """
        reason = reason_of(error, self.package)
        return f"plugin {self.plugin!r}: {what}, from its hook {self.hook}, failed: {reason}"

    def raising(self, what: str, function: Function, checked: Function) -> Function:
        """Return a function that raises `PluginError` where another one fails.

        Parameters
        ----------
        what
            What the function is called.
        function
            Whatever `nodegraph.NodegraphError` it raises are its own words, and pass.
        checked
            Returns what the function gave, ``checked(given, *arguments)``, or raises `Nonsense`.
        """

        def guarded(*arguments: Any) -> Any:
            try:
                return checked(function(*arguments), *arguments)
            except (Exception, SystemExit) as error:
                if isinstance(error, NodegraphError) and not isinstance(error, Nonsense):
                    raise
                raise PluginError(self.failed(what, error)) from error

        return guarded

    def telling(
        self,
        what: str,
        function: Function,
        checked: Function,
        instead: Function,
        told: str = "it is left out",
    ) -> Function:
        """Return a function that warns where another one fails, and gives something instead.

        Parameters
        ----------
        what, function, checked
            As for `raising`; but whatever is raised is told.
        instead
            Returns what is given instead, ``instead(*arguments)``.
        told
            What becomes of it.
        """

        def guarded(*arguments: Any) -> Any:
            try:
                return checked(function(*arguments), *arguments)
            except (Exception, SystemExit) as error:
                warnings.warn(f"{self.failed(what, error)}; {told}", stacklevel=2)
                return instead(*arguments)

        return guarded
