"""An estimator's name -> a node whose settings are those of the estimator."""

from __future__ import annotations

import inspect
import re
import warnings
from dataclasses import replace
from importlib import import_module
from types import NoneType
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import AfterValidator, Field

from nodegraph import NodegraphError, Refusal, nearest, node
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.frame_ranges import runs_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

_FEWEST = 2
"""Frames from which a regressor learns, at least."""

_NOT_SET = ("n_jobs", "verbose", "copy", "copy_X", "missing_values", "add_indicator")
"""Parameters that change no result, or make one that is not a recording; they are not settings."""

_SEED = "random_state"

_MARKUP = re.compile(r"^ +\.\. [^\n]*\n(?:(?: {8,}[^\n]*)?\n)*|:(?:class|func|ref|term):", re.M)
"""Directives and roles that only scikit-learn's own pages show."""


def impute(recording: Trajectories, imputer: Any) -> Trajectories:
    """Return a recording whose gaps an imputer has filled.

    Raises
    ------
    Refusal
        If the imputer drops a column, as some do with one that has no number.
    """
    seen = recording.present.any(axis=0)
    positions = recording.positions.copy()
    if recording.present.all() or not seen.any():
        return _filled(recording, positions)
    rows = positions[:, seen].reshape(recording.frames, -1)
    completed = np.asarray(imputer.fit_transform(rows), dtype=np.float64)
    if completed.shape != rows.shape:
        raise Refusal(f"the imputer returns {completed.shape[1]} columns of {rows.shape[1]}")
    positions[:, seen] = completed.reshape(recording.frames, -1, 3)
    return _filled(recording, positions)


def regress(recording: Trajectories, regressor: Any) -> Trajectories:
    """Return a recording whose gaps a regressor has predicted from other markers.

    A regressor of one output is fitted to each coordinate by itself.
    """
    from sklearn.base import clone
    from sklearn.multioutput import MultiOutputRegressor
    from sklearn.utils import get_tags

    if not get_tags(regressor).target_tags.multi_output:
        regressor = MultiOutputRegressor(regressor)
    present = recording.present
    positions = recording.positions.copy()
    fitted: dict[tuple[int, bytes], Any] = {}
    for marker, start, stop in zip(*runs_of(~present), strict=True):
        others = np.asarray(present[start:stop].all(axis=0))
        learnt = present[:, others].all(axis=1) & present[:, marker]
        if not others.any() or np.count_nonzero(learnt) < _FEWEST:
            continue
        key = int(marker), others.tobytes()
        if key not in fitted:
            fitted[key] = clone(regressor).fit(
                _rows(recording, learnt, others), recording.positions[learnt, marker]
            )
        inside = np.zeros(recording.frames, dtype=bool)
        inside[start:stop] = True
        positions[start:stop, marker] = fitted[key].predict(_rows(recording, inside, others))
    return _filled(recording, positions)


def project(recording: Trajectories, transformer: Any) -> Trajectories:
    """Return a recording with what a transformer keeps of each complete frame.

    Raises
    ------
    Refusal
        If no frame is complete.
    """
    seen = np.asarray(recording.present.any(axis=0))
    whole = np.asarray(recording.present[:, seen].all(axis=1) & seen.any())
    if not whole.any():
        raise Refusal("no frame has every marker, and a transformer takes complete frames only")
    rows = _rows(recording, whole, seen)
    kept = np.asarray(transformer.inverse_transform(transformer.fit_transform(rows)))
    positions = recording.positions.copy()
    positions[np.ix_(whole, seen)] = kept.reshape(len(rows), -1, 3)
    if lost := recording.frames - np.count_nonzero(whole):
        warnings.warn(f"{lost} frames with a missing sample stay as they are", stacklevel=4)
    sigma = recording.sigma
    if sigma is not None:
        moved = (positions != recording.positions).any(axis=2)
        sigma = np.where(moved, np.nan, sigma)
    return replace(recording, positions=positions, sigma=sigma)


def apply_inner(recording: Trajectories, estimator: Any) -> Trajectories:
    """Return what an estimator made of others does: predict if it is a regressor, else project."""
    from sklearn.base import is_regressor

    return (regress if is_regressor(estimator) else project)(recording, estimator)


def _rows(
    recording: Trajectories, frames: NDArray[np.bool_], markers: NDArray[np.bool_]
) -> NDArray[np.float64]:
    chosen = recording.positions[np.ix_(frames, markers)]
    return chosen.reshape(len(chosen), -1)


def _filled(recording: Trajectories, positions: NDArray[np.float64]) -> Trajectories:
    """Return a recording with those filled samples that are finite, and warn of the others."""
    known = np.isfinite(positions).all(axis=2)
    changed = ~recording.present & known
    positions = np.where(changed[..., np.newaxis], positions, recording.positions)
    left = np.count_nonzero(~recording.present & ~known)
    if left:
        markers = np.count_nonzero((~recording.present & ~known).any(axis=0))
        warnings.warn(f"{left} samples of {markers} markers left missing", stacklevel=4)
    return recording.with_samples(positions, changed=changed, origin=Origin.FILLED)


_HOW: dict[Callable[[Trajectories, Any], Trajectories], str] = {
    impute: "Each frame is a row, each coordinate of a marker a column. A marker that is never "
    "measured stays missing.",
    regress: "Each gap of a marker is predicted from the coordinates of the markers that are "
    "present in all of its frames, learnt from the frames in which they and the marker are; a gap "
    "without such markers stays missing, counted in a warning.",
    project: "Each frame is a row, each coordinate of a marker a column; what the transformer "
    "keeps of a complete frame takes its place. Frames with a missing sample stay as they are, "
    "counted in a warning.",
}
_HOW[apply_inner] = (
    f"If it ends in a regressor, it fills: {_HOW[regress][0].lower()}{_HOW[regress][1:]} "
    f"Else it smooths: {_HOW[project][0].lower()}{_HOW[project][1:]}"
)


def node_of_estimator(name: str) -> Callable[..., object]:
    """Return the node that applies an estimator to a recording.

    An imputer or a regressor fills gaps and leaves present samples as they are; a transformer
    that has an inverse smooths; what is made of other estimators, such as a pipeline, does what
    they do. The settings are the parameters of the estimator, with its defaults and checked by
    its rules; ``random_state`` is called ``seed`` and 0, so that the same graph gives the same
    answer. An estimator as a setting is its name, or a mapping of its name to its parameters.

    Parameters
    ----------
    name
        Where the class is: ``sklearn.impute.KNNImputer``.

    Raises
    ------
    NodegraphError
        If scikit-learn has no such class, or it is of no use here.
    """
    kind = _class_named(name)
    apply = _application(kind, name)
    settings = _settings(kind)

    @node("sklearn.estimator", cite="pedregosa2011scikit", lookahead=None)
    def estimator(recording: Trajectories, **parameters: Any) -> Trajectories:
        with np.errstate(all="ignore"):  # what is no number is counted as missing
            return apply(recording, _made(kind, parameters))

    described: Any = estimator
    recorded = inspect.Parameter(
        "recording", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=Trajectories
    )
    described.__signature__ = inspect.Signature(
        [recorded, *settings], return_annotation=Trajectories
    )
    described.__annotations__ = {
        "recording": Trajectories,
        **{setting.name: setting.annotation for setting in settings},
        "return": Trajectories,
    }
    described.__doc__ = _documentation(kind, name, apply)
    return estimator


def _class_named(name: str) -> type[object]:
    module, _, last = name.rpartition(".")
    if module.partition(".")[0] != "sklearn":
        raise NodegraphError(f"write where scikit-learn has it: sklearn.impute.{last or name}")
    if module == "sklearn.impute" and last == "IterativeImputer":
        # scikit-learn has this import as its sign of consent to an experimental class
        import_module("sklearn.experimental.enable_iterative_imputer")
    try:
        holder = import_module(module)
    except ImportError as error:
        raise NodegraphError(f"scikit-learn has no module {module!r}") from error
    kind = getattr(holder, last, None)
    if not isinstance(kind, type):
        classes = [each for each in dir(holder) if inspect.isclass(getattr(holder, each))]
        raise NodegraphError(f"{module} has no class {last!r}; {nearest(last, classes)}")
    return kind


def _application(kind: type[object], name: str) -> Callable[[Trajectories, Any], Trajectories]:
    from sklearn.base import RegressorMixin, TransformerMixin
    from sklearn.pipeline import Pipeline

    if issubclass(kind, TransformerMixin) and kind.__module__.startswith("sklearn.impute"):
        return impute
    if issubclass(kind, RegressorMixin):
        return regress
    if issubclass(kind, Pipeline):
        return apply_inner
    if issubclass(kind, TransformerMixin) and hasattr(kind, "inverse_transform"):
        return project
    raise NodegraphError(
        f"{name} is neither an imputer nor a regressor nor a transformer with an inverse"
    )


def _made(kind: type[object], parameters: dict[str, Any]) -> Any:
    """Return an estimator with its parameters."""
    given = _arguments(kind, parameters)
    if _SEED in inspect.signature(kind).parameters:
        given.setdefault(_SEED, 0)
    return kind(**given)


def _arguments(kind: type[object], parameters: dict[str, Any]) -> dict[str, Any]:
    """Return the parameters of an estimator, those that are estimators made.

    Raises
    ------
    ValueError
        If the estimator has no such parameter, or refuses its value.
    """
    from sklearn.utils._param_validation import validate_parameter_constraints

    known = inspect.signature(kind).parameters
    given = {
        _SEED if name == "seed" else name: _parameter(value) for name, value in parameters.items()
    }
    for name in given:
        if name not in known:
            raise ValueError(f"{kind.__name__} has no parameter {name!r}; {nearest(name, known)}")
    rules = getattr(kind, "_parameter_constraints", {})
    checked = {name: value for name, value in given.items() if name in rules}
    validate_parameter_constraints(rules, checked, kind.__name__)
    return given


def _parameter(value: Any) -> Any:
    """Return the value of a parameter, with estimators in the place of their names."""
    match value:
        case str() if value.startswith("sklearn."):
            return _made(_class_named(value), {})
        case dict() if len(value) == 1:
            ((name, parameters),) = value.items()
            if name.startswith("sklearn.") and isinstance(parameters, dict):
                return _made(_class_named(name), parameters)
        case list():
            made = [_parameter(part) for part in value]
            if any(old is not new for old, new in zip(value, made, strict=True)):
                return [(str(place), part) for place, part in enumerate(made)]
    return value


def _settings(kind: type[object]) -> list[inspect.Parameter]:
    """Return the parameters of an estimator as settings of a node."""
    settings = []
    for parameter in inspect.signature(kind).parameters.values():
        if parameter.name in _NOT_SET or parameter.kind is parameter.VAR_KEYWORD:
            continue
        default = parameter.default
        if parameter.name == _SEED:
            settings.append(_setting("seed", 0, Annotated[int, Field(ge=0)]))
        elif default is parameter.empty or isinstance(default, (bool, int, float, str, NoneType)):
            check = AfterValidator(_check(kind, parameter.name))
            settings.append(_setting(parameter.name, default, Annotated[_hint(default), check]))
    return settings


def _check(kind: type[object], parameter: str) -> Callable[[Any], Any]:
    """Return a function that raises a ValueError if an estimator refuses a parameter's value."""

    def checked(value: Any) -> Any:
        from sklearn.base import is_regressor
        from sklearn.pipeline import Pipeline

        try:
            given = _arguments(kind, {parameter: value})
            if issubclass(kind, Pipeline) and parameter == "steps":
                pipeline = kind(**given)
                useful = is_regressor(pipeline) or hasattr(pipeline, "inverse_transform")
            else:
                useful = True
        except (NodegraphError, TypeError) as error:
            raise ValueError(str(error)) from error
        if not useful:
            raise ValueError(
                "the last step is no regressor, and not all steps are transformers with an inverse"
            )
        return value

    return checked


def _setting(name: str, default: object, hint: object) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint)


def _hint(default: object) -> Any:
    """Return the type of a setting: what an estimator takes beside its default, it checks."""
    if isinstance(default, bool):
        return bool
    if isinstance(default, str):
        return str | float | None
    if isinstance(default, (int, float)):
        return float | int | str | None
    return float | int | str | list[Any] | dict[str, Any] | None


def _documentation(
    kind: type[object], name: str, apply: Callable[[Trajectories, Any], Trajectories]
) -> str:
    doc = inspect.getdoc(kind) or ""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[^\n]*\n-{3,}$|\Z)", doc, re.S | re.M)
    summary = doc.partition("\n")[0].rstrip(".") or kind.__name__
    of_estimator = _MARKUP.sub("", section[1]).rstrip() if section else ""
    of_estimator = re.sub(rf"^{_SEED}\b", "seed", of_estimator, flags=re.M)
    return (
        f"{summary}, by scikit-learn.\n\nThis is `{name}`. {_HOW[apply]}\n\n"
        "Looks at the whole take.\n\n"
        f"Parameters\n----------\nrecording\n    Trajectories.\n{of_estimator}\n"
    )
