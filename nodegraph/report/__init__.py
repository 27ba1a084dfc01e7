"""A study that ran, as one page that needs nothing else."""

from nodegraph.report.page import page
from nodegraph.report.study import (
    AxisRow,
    Link,
    MethodRow,
    Section,
    SettingRow,
    StepNote,
    Study,
    TimingRow,
    WithoutResult,
)

__all__ = [
    "AxisRow",
    "Link",
    "MethodRow",
    "Section",
    "SettingRow",
    "StepNote",
    "Study",
    "TimingRow",
    "WithoutResult",
    "page",
]
