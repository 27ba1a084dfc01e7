"""In which parts of a value it differs from one of which only a lock is left."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from nodegraph.paper.frozen.lock import Lock
from nodegraph.paper.frozen.parts import Parts, Span
from nodegraph.paper.frozen.results import Cell, Results

_NAMED = 5


def where(lock: Lock, cell: Cell, results: Results) -> Iterator[str]:
    """Yield for each array of which the lock knows parts how its shape, or which parts, differ.

    Parameters
    ----------
    lock
    cell
        One that has a value, in the lock and in the run.
    results
        Of the run.
    """
    kept = {
        place: lines[cell.at]
        for place, lines in lock.parts.get(cell.group, {}).items()
        if cell.at in lines
    }
    if not kept:
        return
    most = max([1, *(one.size for was in kept.values() for one in was.sums)])
    found = results.parts(cell.index, most)
    for place, was in kept.items():
        if place in found:
            now, axes = found[place]
            least = lock.data["tolerance"] * lock.scales[cell.group].get(place, 1.0)
            yield from (f"{place}: {one}" for one in _differing(was, now, axes, least))


def _differing(
    was: Parts, now: Parts, axes: Sequence[tuple[str, tuple[str, ...]]], least: float
) -> Iterator[str]:
    if was.shape != now.shape:
        yield f"had the shape {_sizes(was.shape)}, now {_sizes(now.shape)}"
        return
    spans = was.apart(now, least)
    if any(spans):
        named = zip(spans, axes, was.shape, strict=False)
        yield "differs in " + ", of ".join(_named(*one) for one in named)


def _named(spans: list[Span], axis: tuple[str, tuple[str, ...]], members: int) -> str:
    whole = _listed(spans, *axis, members)
    most = [one for one in spans if one.most]
    if len(most) == len(spans):
        return whole
    return f"{whole} (most in {_listed(most, *axis, members)})"


def _listed(spans: list[Span], word: str, names: tuple[str, ...], members: int) -> str:
    runs = list(_joined(spans))
    places = [at for first, last in runs for at in range(first, last + 1)]
    several = f"{word}s" if len(places) > 1 else word
    if len(places) == members:
        return f"all {members} {several}"
    if names:
        more = f" and {len(places) - _NAMED} more" if len(places) > _NAMED else ""
        return f"{several} {', '.join(names[at] for at in places[:_NAMED])}{more}"
    if len(runs) > _NAMED:
        return f"{len(places)} {several} between {places[0]} and {places[-1]}"
    return f"{several} {', '.join(_run(*one) for one in runs)}"


def _joined(spans: list[Span]) -> Iterator[tuple[int, int]]:
    """Yield first and last of spans, as one where they touch."""
    if not spans:
        return
    first, last = spans[0].first, spans[0].last
    for one in spans[1:]:
        if one.first > last + 1:
            yield first, last
            first = one.first
        last = one.last
    yield first, last


def _run(first: int, last: int) -> str:
    return str(first) if first == last else f"{first} to {last}"


def _sizes(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))
