"""Compare methods that process facial motion capture: nodes, graphs, runs, reports."""

from typing import TYPE_CHECKING

from nodegraph import import_time  # noqa: F401 - first, it records the time
from nodegraph.errors import (
    GraphError,
    NodeError,
    NodegraphError,
    Refusal,
    closest,
    listed,
    nearest,
    quoted,
)
from nodegraph.node.declaration import Declared
from nodegraph.node.decorator import node
from nodegraph.node.live_form import (
    FrameForm,
    LiveState,
    RunningForm,
    RunningState,
    StateForm,
    Window,
    WindowForm,
)
from nodegraph.node.ports import (
    Absent,
    Across,
    ColumnOf,
    Columns,
    Deprecated,
    InputFile,
    Label,
    LabelOf,
    Truth,
    Unit,
)
from nodegraph.node.values import Files, Value, read_only

if TYPE_CHECKING:
    from nodegraph.api import load, run
    from nodegraph.kernels import kernel
    from nodegraph.live.forms import fold
    from nodegraph.live.running_numbers import RunningNumbers
    from nodegraph.plugin.formats import formats
    from nodegraph.plugin.hook_types import (
        Command,
        Contract,
        Detail,
        Fact,
        Format,
        Grid,
        Placeholder,
        Provenance,
        Rendered,
        Tried,
        Viewer,
        json_script,
    )
    from nodegraph.plugin.hooks import hookimpl
    from nodegraph.plugin.kind import Kind, late
    from nodegraph.plugin.registry import get_node
    from nodegraph.plugin.streaming import Frame, LiveView, Sink, Source, Streamable
    from nodegraph.report.page import standalone_page

__all__ = [
    "Absent",
    "Across",
    "ColumnOf",
    "Columns",
    "Command",
    "Contract",
    "Declared",
    "Deprecated",
    "Detail",
    "Fact",
    "Files",
    "Format",
    "Frame",
    "FrameForm",
    "GraphError",
    "Grid",
    "InputFile",
    "Kind",
    "Label",
    "LabelOf",
    "LiveState",
    "LiveView",
    "NodeError",
    "NodegraphError",
    "Placeholder",
    "Provenance",
    "Refusal",
    "Rendered",
    "RunningForm",
    "RunningNumbers",
    "RunningState",
    "Sink",
    "Source",
    "StateForm",
    "Streamable",
    "Tried",
    "Truth",
    "Unit",
    "Value",
    "Viewer",
    "Window",
    "WindowForm",
    "closest",
    "fold",
    "formats",
    "get_node",
    "hookimpl",
    "json_script",
    "kernel",
    "late",
    "listed",
    "load",
    "nearest",
    "node",
    "quoted",
    "read_only",
    "run",
    "standalone_page",
]

_LATE = {
    "load": "nodegraph.api",
    "run": "nodegraph.api",
    "Frame": "nodegraph.plugin.streaming",
    "Kind": "nodegraph.plugin.kind",
    "LiveView": "nodegraph.plugin.streaming",
    "RunningNumbers": "nodegraph.live.running_numbers",
    "Sink": "nodegraph.plugin.streaming",
    "Source": "nodegraph.plugin.streaming",
    "Streamable": "nodegraph.plugin.streaming",
    "fold": "nodegraph.live.forms",
    "formats": "nodegraph.plugin.formats",
    "get_node": "nodegraph.plugin.registry",
    "hookimpl": "nodegraph.plugin.hooks",
    "kernel": "nodegraph.kernels",
    "late": "nodegraph.plugin.kind",
    "standalone_page": "nodegraph.report.page",
}


def __getattr__(name: str) -> object:
    # every command imports this package, and few need more of it than the errors
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_LATE.get(name, "nodegraph.plugin.hook_types")), name)


def __dir__() -> list[str]:
    return sorted(__all__)
