"""Whether a node keeps what nodes promise, and what its family promises."""

from __future__ import annotations

import inspect
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from nodegraph.errors import NodeError, nearest
from nodegraph.node.decorator import Node, node_of
from nodegraph.node.description import meanings, setting_kind
from nodegraph.plugin.bibliography import entry_keys
from nodegraph.plugin.guards import PluginError, Source
from nodegraph.plugin.hook_types import Contract, Tried, expect
from nodegraph.plugin.loading import error_text, package_of
from nodegraph.plugin.registry import Registry, default_registry
from nodegraph.testing.specimens import cases, examples, without_specimens
from nodegraph.testing.trial import Faults, Trial

_OTHER_NAMES_OF_SEED = {"rng", "random", "random_seed", "random_state", "generator"}


def unreadable(node: Node) -> str:
    """Return why the signature is not a node's, or an empty text.

    Parameters
    ----------
    node
        Any.
    """
    try:
        node.check()
    except NodeError as error:
        return str(error)
    return ""


def declaration_faults(node: Node, given: Mapping[str, Any]) -> Iterator[str]:
    """Yield what name, docstring and settings lack; `given` are values for settings.

    Parameters
    ----------
    node
        One that can be read.
    given
        Values for settings.
    """
    if not node.summary.strip():
        yield "has no docstring: say in its first line what the method does; users see it in lists"
    documented = meanings(node)
    for name in node.settings:
        if not documented.get(name):
            yield (
                f"setting {name!r} is not documented: say under 'Parameters' in the docstring what "
                "it means; the tool shows that text to users"
            )
        if name in _OTHER_NAMES_OF_SEED:
            yield f"setting {name!r} is randomness by another name: call it seed, a whole number"
    yield from _value_faults(node, given)


def _value_faults(node: Node, given: Mapping[str, Any]) -> Iterator[str]:
    from pydantic import ValidationError

    defaults = {one.name: one.default for one in node.settings.values() if not one.required}
    try:
        node.model.model_validate({**defaults, **given})
    except ValidationError as error:
        for one in error.errors():
            if one["loc"] and one["type"] not in ("missing", "extra_forbidden"):
                yield _value_fault(node, given, str(one["loc"][0]), one["msg"])


def _value_fault(node: Node, given: Mapping[str, Any], name: str, message: str) -> str:
    what, value = (
        ("the given value", given[name])
        if name in given
        else ("the default", node.settings[name].default)
    )
    return (
        f"setting {name!r}: {what} {value!r} is not {setting_kind(node, name)}: {message}; "
        "change the value or the type and bounds"
    )


def citation_faults(node: Node, registry: Registry) -> Iterator[str]:
    """Yield the keys that a node cites and its plugin does not ship, or why nobody can tell.

    Parameters
    ----------
    node
        Whose `cite` is looked at.
    registry
        Whose plugins ship BibTeX, where the node's own package has none.
    """
    if not node.cite:
        return
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            there = entry_keys(_bibtex(node, registry))
        except PluginError as fails:
            yield f"{fails}: mend it, or nobody learns what the node cites"
            return
    for one in said:
        yield f"{one.message}: mend what its hook nodegraph_bibtex returns"
    for key in node.cite:
        if key not in there:
            yield (
                f"cites {key!r}, which its plugin does not ship ({nearest(key, there)}): put the "
                "entry into the BibTeX that its hook nodegraph_bibtex returns"
            )


def _bibtex(node: Node, registry: Registry) -> Iterable[str]:
    """Return the BibTeX of the node's package, else of its plugin, else of every plugin."""
    parts = node.function.__module__.split(".")
    names = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
    brought = {one.plugin for one in registry if one.node.function is node.function}
    plugins = [one.module for one in registry.loaded if one.name in brought]
    for module in (*(sys.modules.get(name) for name in names), *plugins):
        if hook := getattr(module, "nodegraph_bibtex", None):
            return [_call_bibtex(hook)]
    return registry.hooks.bibtex


def _call_bibtex(hook: Callable[[], Any]) -> str:
    try:
        return str(expect(hook(), str))
    except (Exception, SystemExit) as error:
        reason = error_text(error, package_of(hook))
        raise PluginError(f"its plugin's hook nodegraph_bibtex failed: {reason}") from error


def check_node(
    node: Callable[..., Any],
    *,
    inputs: Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    registry: Registry | None = None,
) -> None:
    """Check everything that a node promises, and all that its family does.

    Its name and signature can be read; it has a docstring, which says what each setting means;
    its defaults lie within their own bounds; its plugin ships what it cites. On every specimen
    that the plugins ship for its ports' types (recordings with gaps, of one frame, all missing,
    ...) it returns what its annotation says, without infinite numbers, or declines in words of
    its own, by `nodegraph.Refusal` or ValueError; it gives the same answer twice, whatever the
    global random state, by keyword and by position, made anew each time; and it leaves its inputs
    as they were, and so the process: it prints nothing, writes no file, lets no RuntimeWarning of
    numpy out, changes no environment, folder, filter of warnings or setting of numpy and
    matplotlib. On each, its tables have no columns but those that it declares, if it does, and the
    contracts of its family hold. It does not decline all of them; whether it does anything to
    those that it takes is not asked, as a fill of a recording without gaps does nothing either.

    Parameters
    ----------
    node
        A function decorated with `nodegraph.node.decorator`.
    inputs
        Values for ports, instead of specimens: for types of which no plugin ships any.
    settings
        Values for settings: for those that have neither a default nor an example, as in
        ``Annotated[int, Field(examples=[5])]``.
    registry
        Whose specimens and contracts; those of all installed plugins by default.

    Raises
    ------
    AssertionError
        With every fault: what is wrong, on which specimen it shows, and what to change.

    Examples
    --------
    >>> from nodegraph import get_node
    >>> check_node(get_node("fill.muscle"))  # doctest: +SKIP
    """
    described = node_of(node)
    if described is None:
        raise AssertionError(f"{node!r} is not a node: decorate it with @node('family.method')")
    faults = Faults()
    _find_faults(described, inputs or {}, settings or {}, registry or default_registry(), faults)
    if faults:
        raise AssertionError(f"{described.name} does not keep its promises:\n{faults.text()}")


def _find_faults(
    node: Node,
    inputs: Mapping[str, Any],
    settings: Mapping[str, Any],
    registry: Registry,
    faults: Faults,
) -> None:
    reason = unreadable(node)
    if reason:
        faults.add(f"cannot be read as a node: {reason}")
        return
    settings = {**examples(node), **settings}
    for fault in declaration_faults(node, settings):
        faults.add(fault)
    for fault in citation_faults(node, registry):
        faults.add(fault)
    uncallable = list(_uncallable(node, inputs, settings, registry))
    for fault in uncallable:
        faults.add(fault)
    if not uncallable:
        _try(node, inputs, settings, registry, faults)


def _uncallable(
    node: Node, inputs: Mapping[str, Any], settings: Mapping[str, Any], registry: Registry
) -> Iterator[str]:
    for port in without_specimens(node, inputs, registry):
        yield (
            f"port {port.name!r}: no installed plugin ships a specimen of {port.type.__name__}: "
            "ship one by the hook nodegraph_specimens, or test with "
            f"check_node(..., inputs={{{port.name!r}: ...}})"
        )
    for name in inputs.keys() - {port.name for port in node.inputs}:
        ports = ", ".join(port.name for port in node.inputs) or "none"
        yield f"inputs: there is no port {name!r}; there is {ports}"
    for name in settings.keys() - node.settings.keys():
        known = ", ".join(node.settings) or "none"
        yield f"settings: there is no setting {name!r}; there is {known}"
    for name, one in node.settings.items():
        if one.required and name not in settings:
            yield (
                f"setting {name!r} has no default: give it an example, "
                "Annotated[..., Field(examples=[...])], or test with "
                f"check_node(..., settings={{{name!r}: ...}})"
            )


def _try(
    node: Node,
    inputs: Mapping[str, Any],
    settings: Mapping[str, Any],
    registry: Registry,
    faults: Faults,
) -> None:
    contracts = list(registry.hooks.contracts(node.family))
    declined: list[str] = []
    done = 0
    for specimen, values in cases(node, inputs, registry):
        trial = Trial(node, specimen, values, settings, faults)
        made = trial.outputs()
        if isinstance(made, str):
            declined.append(f"{specimen!r}: {made}")
        elif made is not None:
            done += 1
            _compare_columns(trial, made)
            for contract, source in contracts:
                _hold(contract, source, trial, made)
    if not done and not faults:
        faults.add("declines every specimen, so that nothing of it is tested", detail=declined[0])


def _compare_columns(trial: Trial, outputs: Mapping[str, Any]) -> None:
    for port in trial.node.outputs:
        there = [str(name) for name in getattr(outputs[port.name], "columns", ())]
        new = [name for name in there if name not in port.columns]
        if port.columns and new:
            trial.fault(
                f"output {port.name!r} has columns that it does not declare: name them in "
                "Columns(...), or leave that away if they depend on the data",
                ", ".join(new),
            )


def _hold(contract: Contract, source: Source, trial: Trial, outputs: Mapping[str, Any]) -> None:
    name = getattr(contract, "__name__", repr(contract))
    promise = (inspect.getdoc(contract) or name).partition("\n")[0].rstrip(".")
    family = trial.node.family
    described = trial.node.settings
    defaults = {name: one.default for name, one in described.items() if not one.required}
    units = {name: one.unit for name, one in described.items() if one.unit}
    settings = {**defaults, **trial.settings}
    tried = Tried(trial.inputs, outputs, settings, units, trial.node.doc, trial.again)
    try:
        broken = list(contract(tried))
    except Exception as error:
        broken = [source.failure(name, error)]
    for detail in broken:
        trial.fault(f"breaks what every {family}.* node promises: {promise}", detail)
