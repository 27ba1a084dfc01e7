from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kruskal

from nodegraph import Label
from nodegraph_compare.overview.cost import typical_seconds


@pytest.mark.parametrize("methods", [2, 3, 4, 7])
def test_times_are_shown_where_a_test_of_kruskal_and_wallis_tells_methods_apart(
    methods: int,
) -> None:
    random = np.random.default_rng(methods)
    shown = []
    for _ in range(40):
        faster = random.uniform(0, 0.6, methods)
        times: dict[Label, list[float]] = {
            f"method {at}": [9.0, *np.round(random.uniform(each, 1 + each, 8), 1)]
            for at, each in enumerate(faster)
        }
        shown.append(bool(typical_seconds(times)))
        assert shown[-1] == (kruskal(*(each[1:] for each in times.values())).pvalue <= 0.05)
    assert {*shown} == {True, False}
