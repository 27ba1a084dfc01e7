"""Which end of a metric is the better one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, cast, get_args

if TYPE_CHECKING:
    from nodegraph import Across
    from nodegraph_mocap import Table

End = Literal["lower", "higher", "none"]
Better = Literal["declared", "lower", "higher", "none"]


def better_end(scores: Across[Table], metric: str, better: Better) -> End:
    """Return which end of the metric is better: as asked, else as the tables declare, else lower.

    A table declares it in ``attrs["better"]``, a mapping of column to ``lower``, ``higher`` or
    ``none``, the last for a column that is best at some value between.

    Parameters
    ----------
    scores
        The gathered tables.
    metric
        The column of numbers.
    better
        What was asked for; ``declared``: as the tables say.

    Raises
    ------
    ValueError
        If the tables declare two ends, or something else.
    """
    if better != "declared":
        return better
    told = {one.attrs.get("better", {}).get(metric, "lower") for one in scores.values()}
    wrong = sorted(str(one) for one in told if one not in get_args(End))
    if wrong:
        raise ValueError(
            f"a table declares {wrong[0]!r} as the better end of {metric!r}; "
            f"there are: {', '.join(get_args(End))}"
        )
    if len(told) > 1:
        raise ValueError(
            f"the tables declare different ends of {metric!r} as the better one: "
            f"{', '.join(sorted(told))}; give `better`"
        )
    return cast(End, told.pop())


def sign_of(end: End) -> float:
    """Return 1.0, or -1.0 where higher is better: the best has the lowest value times this."""
    return -1.0 if end == "higher" else 1.0
