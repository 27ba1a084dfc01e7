"""The DataFrame that carries a `TableInfo`; its own module, so that pandas is imported late."""

from __future__ import annotations

from typing import ClassVar

import pandas as pd


class TableFrame(pd.DataFrame):
    """A DataFrame with a `TableInfo`, as pandas lets subclasses carry metadata."""

    _metadata: ClassVar[list[str]] = ["table_info"]
    table_info: object = None

    @property
    def _constructor(self) -> type[TableFrame]:
        return TableFrame
