"""Check that a node keeps the promises of all nodes, and those of its family."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping

from nodegraph.errors import NodeError, nearest
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.node.decorator import Node, node_of
from nodegraph.node.description import meanings, setting_kind
from nodegraph.plugin.bibliography import entry_keys
from nodegraph.plugin.formats import formats_of
from nodegraph.plugin.guards import PluginError
from nodegraph.plugin.hook_types import expect
from nodegraph.plugin.loading import error_text, package_of
from nodegraph.plugin.registry import Registry, default_registry
from nodegraph.testing.faults import Faults
from nodegraph.testing.live import check_live_form
from nodegraph.testing.specimens import cases, examples, ports_without_specimens
from nodegraph.testing.trial import Trial

_OTHER_NAMES_OF_SEED = {"rng", "random", "random_seed", "random_state", "generator"}


def check_node(
    node: Callable[..., object],
    *,
    inputs: Mapping[str, object] | None = None,
    settings: Mapping[str, object] | None = None,
    registry: Registry | None = None,
) -> None:
    """Check everything that a node promises, and all that its family does.

    Its name and signature can be read; its docstring documents each setting; its defaults lie
    within their own bounds; its plugin ships the references that it cites.

    The node is called on every specimen that the plugins ship for its ports' types (recordings
    with gaps, of one frame, all missing, ...):

    - It returns what its annotation declares, without infinite numbers, or declines in its own
      words, by `nodegraph.Refusal` or ValueError; it does not decline all specimens.
    - It returns the same result twice, whatever the global random state, with inputs by keyword
      or by position, and in arrays of its own.
    - It does not modify its inputs or the process: it prints nothing, writes no file, lets no
      RuntimeWarning of numpy out, and changes no environment variable, working directory, filter
      of warnings, or setting of numpy and matplotlib.
    - Its tables have no columns but those that it declares, if it declares any.
    - The contracts of its family hold.
    - Its live form, if it has one, gives on a stream what the function gives of the whole take,
      bit for bit: of all frames, of only the first ones, with frames missing anywhere, and of a
      take of 400 frames with a gap of 90; each frame `lookahead` frames later, at the end exactly
      the rest; two streams do not disturb each other. A take that the function refuses is none.

    A node that accepts a specimen need not do anything to it: a fill of a recording without gaps
    does nothing either.

    Parameters
    ----------
    node
        A function decorated with `nodegraph.node`.
    inputs
        Values for ports, instead of specimens: for types of which no plugin ships any.
    settings
        Values for settings: for those that have neither a default nor an example, as in
        ``Annotated[int, Field(examples=[5])]``.
    registry
        The plugins with specimens and contracts; by default all that are installed.

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
    _check(described, inputs or {}, settings or {}, registry or default_registry(), faults)
    if faults:
        raise AssertionError(f"{described.name} does not keep its promises:\n{faults.text()}")


def _check(
    node: Node,
    inputs: Mapping[str, object],
    settings: Mapping[str, object],
    registry: Registry,
    faults: Faults,
) -> None:
    try:
        node.check()
    except NodeError as error:
        faults.add(f"cannot be read as a node: {error}")
        return
    settings = {**examples(node), **settings}
    for fault in (*_declaration_faults(node, settings), *_citation_faults(node, registry)):
        faults.add(fault)
    obstacles = list(_obstacles(node, inputs, settings, registry))
    for obstacle in obstacles:
        faults.add(obstacle)
    if not obstacles:
        with formats_of(registry), one_thread_each():  # as in a run
            _call_on_specimens(node, inputs, settings, registry, faults)


def _declaration_faults(node: Node, settings: Mapping[str, object]) -> Iterator[str]:
    """Yield the faults of the docstring and the settings, or of given values of these."""
    if not node.summary.strip():
        yield "has no docstring: say in its first line what the method does; users see it in lists"
    documented = meanings(node)
    for name in node.settings:
        if not documented.get(name):
            yield (
                f"setting {name!r} is not documented: say under 'Parameters' in the docstring what "
                "it means; that text is shown to users"
            )
        if name in _OTHER_NAMES_OF_SEED:
            yield f"setting {name!r} is randomness by another name: call it seed, a whole number"
    yield from _value_faults(node, settings)


def _value_faults(node: Node, settings: Mapping[str, object]) -> Iterator[str]:
    from pydantic import ValidationError

    defaults = node.defaults
    try:
        node.model.model_validate({**defaults, **settings})
    except ValidationError as errors:
        for error in errors.errors():
            if error["loc"] and error["type"] not in ("missing", "extra_forbidden"):
                name = str(error["loc"][0])
                given = name in settings
                value = settings[name] if given else defaults[name]
                yield (
                    f"setting {name!r}: the {'given value' if given else 'default'} {value!r} is "
                    f"not {setting_kind(node, name)}: {error['msg']}; change the value or the "
                    "type and bounds"
                )


def _citation_faults(node: Node, registry: Registry) -> Iterator[str]:
    """Yield the keys that a node cites and its plugin does not ship, or why that is unknown."""
    if not node.cite:
        return
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            keys = entry_keys(_bibtex(node, registry))
        except PluginError as error:
            yield f"{error}: fix it, or nobody learns what the node cites"
            return
    for warning in caught:
        yield f"{warning.message}: fix what its hook nodegraph_bibtex returns"
    for key in node.cite:
        if key not in keys:
            yield (
                f"cites {key!r}, which its plugin does not ship ({nearest(key, keys)}): put the "
                "entry into the BibTeX that its hook nodegraph_bibtex returns"
            )


def _bibtex(node: Node, registry: Registry) -> Iterable[str]:
    """Return the BibTeX of the node's package, else of its plugin, else of every plugin."""
    parts = node.function.__module__.split(".")
    packages = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
    names = {each.plugin for each in registry if each.node.function is node.function}
    plugins = [plugin.module for plugin in registry.loaded if plugin.name in names]
    for module in (*map(sys.modules.get, packages), *plugins):
        if hook := getattr(module, "nodegraph_bibtex", None):
            try:
                return [expect(hook(), str)]
            except (Exception, SystemExit) as error:
                reason = error_text(error, package_of(hook))
                message = f"its plugin's hook nodegraph_bibtex failed: {reason}"
                raise PluginError(message) from error
    bibtex: Iterable[str] = registry.hooks.of("bibtex")
    return bibtex


def _obstacles(
    node: Node, inputs: Mapping[str, object], settings: Mapping[str, object], registry: Registry
) -> Iterator[str]:
    """Yield why a node cannot be called: no value for a port or a setting, or a wrong name."""
    for port in ports_without_specimens(node, inputs, registry):
        yield (
            f"port {port.name!r}: no installed plugin ships a specimen of {port.type.__name__}: "
            "ship one by the hook nodegraph_kinds, or test with "
            f"check_node(..., inputs={{{port.name!r}: ...}})"
        )
    for name in inputs.keys() - {port.name for port in node.inputs}:
        ports = ", ".join(port.name for port in node.inputs) or "none"
        yield f"inputs: there is no port {name!r}; there is {ports}"
    for name in settings.keys() - node.settings.keys():
        known = ", ".join(node.settings) or "none"
        yield f"settings: there is no setting {name!r}; there is {known}"
    for name, setting in node.settings.items():
        if setting.required and name not in settings:
            yield (
                f"setting {name!r} has no default: give it an example, "
                "Annotated[..., Field(examples=[...])], or test with "
                f"check_node(..., settings={{{name!r}: ...}})"
            )


def _call_on_specimens(
    node: Node,
    inputs: Mapping[str, object],
    settings: Mapping[str, object],
    registry: Registry,
    faults: Faults,
) -> None:
    declined: list[str] = []
    is_accepted = is_long_checked = False
    for specimen, values in cases(node, inputs, registry):
        trial = Trial(node, specimen, values, settings, faults)
        outputs = trial.outputs()
        if isinstance(outputs, str):
            declined.append(f"{specimen!r}: {outputs}")
        elif outputs is not None:
            is_accepted = True
            _check_columns(trial, outputs)
            if node.live is not None:
                # one is enough: most is long on a stream that is not on a whole take
                check_live_form(trial, outputs, long=not is_long_checked)
                is_long_checked = True
            for promise, violation in registry.hooks.broken_promises(
                node, trial.inputs, outputs, trial.settings, trial.again
            ):
                trial.add_fault(
                    f"breaks what every {node.family}.* node promises: {promise}", violation
                )
    if not is_accepted and not faults:
        faults.add("declines every specimen, so that nothing of it is tested", detail=declined[0])


def _check_columns(trial: Trial, outputs: Mapping[str, object]) -> None:
    for port in trial.node.outputs:
        columns = [str(name) for name in getattr(outputs[port.name], "columns", ())]
        undeclared = [name for name in columns if name not in port.columns]
        if port.columns and undeclared:
            trial.add_fault(
                f"output {port.name!r} has columns that it does not declare: name them in "
                "Columns(...), or omit that if they depend on the data",
                ", ".join(undeclared),
            )
