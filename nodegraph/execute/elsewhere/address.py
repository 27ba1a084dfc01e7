"""How a node is found in another process: whose it is, what it is called, where it was defined."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from nodegraph.execute.call import Call
from nodegraph.node import Node
from nodegraph.registry import Registry


@dataclass(frozen=True)
class Address:
    """Where another process looks for a node.

    Attributes
    ----------
    plugin, node : str
    distribution : str
        Name and version of the package that brings the plugin here; empty for a file.
    module, qualname : str
        Where the function was defined, for a node that no plugin brings.
    """

    plugin: str
    node: str
    distribution: str
    module: str
    qualname: str

    @classmethod
    def of(cls, call: Call, registry: Registry) -> Address | None:
        """Return where another process finds the node of a call, or None if nowhere."""
        if type(call.node) is not Node or call.plugin == "nodegraph":
            return None  # it was made for this graph
        function = call.node.function
        module, qualname = function.__module__, function.__qualname__
        brought = {one.name: one.distribution for one in registry.loaded}
        if call.plugin not in brought and not _is_importable(function):
            return None
        distribution = brought.get(call.plugin, "")
        return cls(call.plugin, call.node.name, distribution, module, qualname)

    def as_bytes(self) -> bytes:
        """Return it as JSON."""
        return json.dumps(asdict(self)).encode()

    @classmethod
    def from_bytes(cls, text: bytes) -> Address:
        """Return what `as_bytes` made a text of."""
        return cls(**json.loads(text))


def _is_importable(function: Callable[..., Any]) -> bool:
    """Whether the function is what its name stands for in a module that others can import."""
    if function.__module__ == "__main__":
        return False
    found: Any = sys.modules.get(function.__module__)
    for part in function.__qualname__.split("."):
        found = getattr(found, part, None)
    return found is function
