"""Calls as messages to other processes: a node by its name, values as the store packs them.

A message is a list of buffers, of which the first few are JSON. No code travels but the plugin
files of a run.
"""

from __future__ import annotations

import atexit
import json
import platform
import shutil
import sys
import tempfile
import threading
import warnings
from collections.abc import Mapping, Sequence
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph.cache_key import code_of
from nodegraph.errors import UnknownNodeError
from nodegraph.execute.call import Call, collecting_warnings, perform
from nodegraph.execute.numeric_threads import SharedContext, one_thread_each
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.threads import in_time
from nodegraph.node.decorator import Node, node_of
from nodegraph.plugin.registry import Registry
from nodegraph.state import State
from nodegraph.store import Packer, Unreadable, Unstorable

Frame = bytes | memoryview

VERSIONS = {"Python": ".".join(platform.python_version_tuple()[:2]), "numpy": np.__version__}
"""Versions between which results may differ in their last digits."""

_SENT = ("state", "reason", "trace", "warnings", "seconds", "place", "undeclared_reads")
"""The fields of an outcome that are sent beside its values."""


class CallCodec:
    """Encodes calls as requests, and decodes responses to outcomes.

    Parameters
    ----------
    registry
        The plugins that define the nodes.
    packer
        Packs values.
    local
        Whether workers start on this machine after this process, and so see the same files and
        have the same code.
    """

    def __init__(self, registry: Registry, packer: Packer, *, local: bool) -> None:
        self._packer = packer
        self._local = local
        files = [Path(p.module.__file__) for p in registry.loaded if not p.distribution]
        contents = [(str(path), path.read_bytes().decode("latin-1")) for path in files]
        self._files = json.dumps(contents).encode()
        self._distributions = {plugin.name: plugin.distribution for plugin in registry.loaded}
        self._code = None if local else code_of(registry)
        self._addresses: dict[int, bytes | None] = {}
        self._reported: set[str] = set()

    def encode(self, call: Call) -> list[Frame] | None:
        """Return a call as a request, or None if it must be made in this process."""
        # by identity: the plan keeps the nodes, and comparing them would read their signatures
        known = id(call.node)
        if known not in self._addresses:
            self._addresses[known] = self._address(call)
        address = self._addresses[known]
        if address is None or (not self._local and _reads_file(call)):
            return None
        try:
            packed = self._packer.pack((dict(call.inputs), dict(call.settings)))
        except Unstorable:
            return None
        if not packed.faithful:
            return None
        return [self._files, address, packed.head.encode(), *packed.buffers]

    def decode(self, response: Sequence[Frame], worker: str) -> Outcome | str:
        """Return the outcome in a response, or why the call must be made in this process.

        Parameters
        ----------
        response
        worker
            Name of the worker in messages.
        """
        about, head, *buffers = response
        fields: dict[str, Any] = json.loads(bytes(about))
        if "unsendable" in fields:
            return str(fields["unsendable"])
        if "missing" in fields:
            reason = f"{worker} {fields['missing']}"
            # a process of this machine lacks a node only if it cannot be imported at all
            return reason if self._local else Outcome(State.FAILED, reason=reason)
        self._compare(fields.pop("versions"), worker)
        try:
            values = self._packer.unpack(bytes(head).decode(), buffers)
        except Unreadable as error:
            return str(error)
        fields |= {
            "state": State(fields["state"]),
            "warnings": tuple(fields["warnings"]),
            "undeclared_reads": tuple(fields["undeclared_reads"]),
        }
        return Outcome(values=values, **fields)

    def _address(self, call: Call) -> bytes | None:
        """Return the address of a node, or None if no other process can find it."""
        node = call.node
        if type(node) is not Node or call.plugin == "nodegraph":
            return None  # it exists in this graph only
        if not all(self._packer.travels(port.type) for port in (*node.inputs, *node.outputs)):
            return None
        function = node.function
        place = function.__module__, function.__qualname__
        if call.plugin not in self._distributions and _defined(*place) is not node:
            return None
        code = self._code.of(function).units if self._code is not None else None
        distribution = self._distributions.get(call.plugin)
        return json.dumps([call.plugin, node.name, distribution, code, *place]).encode()

    def _compare(self, versions: Mapping[str, str], worker: str) -> None:
        """Warn, once, of the versions of a worker that are not those of this process."""
        differences = "; ".join(
            f"{name} {versions[name]}, here it is {here}"
            for name, here in VERSIONS.items()
            if versions[name] != here
        )
        if differences and differences not in self._reported:
            self._reported.add(differences)
            warnings.warn(
                f"{worker} has {differences}: results may differ in their last digits",
                stacklevel=3,
            )


def _reads_file(call: Call) -> bool:
    settings = call.node.settings.items()
    return any(s.is_file and call.settings.get(name) is not None for name, s in settings)


class _MissingNode(Exception):
    """The node of a request is not in this process; the text says why."""


class _Plugins:
    """The nodes of the installed plugins and of the plugin files of one sender.

    Parameters
    ----------
    files
        Pairs of path and content.
    """

    def __init__(self, files: Sequence[tuple[str, str]]) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the run itself warns of plugins that are broken
            self.registry = Registry.installed([_same_file(Path(p), text) for p, text in files])
        # a value may be of a class in any module that a plugin uses
        self.packer = Packer(self.registry.hooks.kinds, lambda package: True)
        self._distributions = {each.name: each.distribution for each in self.registry.loaded}
        self._code = code_of(self.registry)
        self._known: dict[bytes, tuple[Node, str]] = {}

    def find(self, address: bytes) -> tuple[Node, str]:
        """Return the node at an address, and the name of its plugin.

        Raises
        ------
        _MissingNode
            If this process does not have it, or another version of it.
        """
        if address not in self._known:
            plugin, name, distribution, code, module, qualname = json.loads(address)
            if distribution is None:
                node = _defined(module, qualname)
            else:
                node = self._find(plugin, name, distribution, code)
            if node is None:
                raise _MissingNode(f"cannot import {name} from {module}")
            self._known[address] = node, plugin
        return self._known[address]

    def _find(
        self, plugin: str, name: str, distribution: str, code: Mapping[str, str] | None
    ) -> Node:
        try:
            registered = self.registry.find(f"{plugin}:{name}")
        except UnknownNodeError:
            raise _MissingNode(self._why_missing(plugin, name, distribution)) from None
        there = self._distributions.get(plugin, registered.distribution)
        if there != distribution:
            theirs, ours = (text or "a file" for text in (there, distribution))
            raise _MissingNode(f"has {theirs}, here it is {ours}, for {name}")
        if code is not None:
            here = self._code.of(registered.node.function)
            names = sorted({*code, *here.units})
            other = [unit for unit in names if code.get(unit) != here.units.get(unit)]
            if other or here.unstable:
                raise _MissingNode(
                    f"has other code of {other[0] if other else name} than here, for {name}; "
                    "install the same version there, and restart its workers"
                )
        return registered.node

    def _why_missing(self, plugin: str, name: str, distribution: str) -> str:
        for broken in self.registry.broken:
            if broken.name == plugin:
                return f"has left out the plugin {plugin!r}, which defines {name}: {broken.reason}"
        there = self._distributions.get(plugin)
        if there is None:
            version = f" ({distribution})" if distribution else ""
            return f"has no plugin {plugin!r}, which defines {name}; install it there{version}"
        versions = f" (it has {there}, here it is {distribution})" if there else ""
        return f"has no node {name} in its plugin {plugin!r}{versions}"


def _defined(module: str, qualname: str) -> Node | None:
    """Return the node of that name in a module, which other processes can import, or None."""
    if module == "__main__":
        return None
    try:
        return node_of(attrgetter(qualname)(import_module(module)))
    except (Exception, SystemExit):
        return None


_lock = threading.RLock()
_plugins: dict[bytes, _Plugins] = {}
_imported: set[str] = set()
"""Names of the modules that plugin files of senders are."""
_warnings = SharedContext(collecting_warnings)


def plugins_of(request: Sequence[Frame]) -> _Plugins:
    """Load the plugins that the sender of a request has, once for all of its requests."""
    key = bytes(request[0])
    with _lock:  # threads of one process would import a plugin twice
        if key not in _plugins:
            files = json.loads(key)
            names = {Path(path).stem for path, _ in files}
            if names & _imported:
                # earlier files of the same names may be different, and so would be their classes
                for name in names & _imported:
                    sys.modules.pop(name, None)
                _plugins.clear()
            _imported.update(names)
            _plugins[key] = _Plugins(files)
        return _plugins[key]


def respond(request: Sequence[Frame], timeout: float | None = None) -> list[Frame]:
    """Find the node of a request, call it, and return the response.

    Parameters
    ----------
    request
    timeout
        Seconds that the call may take; one that takes longer continues until this process ends.
    """
    _, address, head, *buffers = request
    try:
        plugins = plugins_of(request)
    except Exception as error:  # a plugin file does not import here
        return _without_outcome("missing", f"cannot use a plugin file: {error}")
    try:
        with _lock:
            node, plugin = plugins.find(bytes(address))
        inputs, settings = plugins.packer.unpack(bytes(head).decode(), buffers)
        call = Call(0, node, plugin, inputs, settings, "", plugins.registry, timeout)
        del inputs, settings
        with _warnings.entered(), one_thread_each():
            outcome = in_time(perform, call)
        sys.stdout.flush()  # a worker may be ended at any time
        packed = plugins.packer.pack(outcome.values)
    except _MissingNode as error:
        return _without_outcome("missing", str(error))
    except (Unreadable, Unstorable) as error:
        return _without_outcome("unsendable", str(error))
    if not packed.faithful:
        return _without_outcome("unsendable", "only a stand-in of a value can be sent")
    about = {name: getattr(outcome, name) for name in _SENT} | {"versions": VERSIONS}
    return [json.dumps(about).encode(), packed.head.encode(), *packed.buffers]


def _without_outcome(kind: str, reason: str) -> list[Frame]:
    return [json.dumps({kind: reason}).encode(), b"null"]


def _same_file(path: Path, content: str) -> Path:
    """Return a file of that content: the same one, or a copy if it is not the same here."""
    read = content.encode("latin-1")
    try:
        if path.read_bytes() == read:
            return path
    except OSError:
        pass
    folder = Path(tempfile.mkdtemp(prefix="nodegraph-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    copy = folder / path.name
    copy.write_bytes(read)
    return copy
