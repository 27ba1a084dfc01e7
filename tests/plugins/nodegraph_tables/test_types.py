from __future__ import annotations

import subprocess
import sys

import pandas as pd
from matplotlib.figure import Figure as Drawn

from nodegraph_mocap import Figure, Table


def test_the_names_recognise_what_they_stand_for() -> None:
    class Special(pd.DataFrame):
        pass

    assert isinstance(pd.DataFrame(), Table)
    assert issubclass(Special, Table)
    assert isinstance(Drawn(), Figure)
    assert issubclass(Table, Table)


def test_asking_imports_nothing_slow() -> None:
    program = (
        "import sys; from nodegraph_mocap import Figure, Table;"
        "assert not isinstance(1, Table) and not isinstance(1, Figure);"
        "slow = {'pandas', 'matplotlib', 'scipy', 'ezc3d', 'numba', 'yaml', 'sklearn'};"
        "print(sorted(slow & set(sys.modules)))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert ended.stdout == "[]\n"
