"""Tables and figures travel as what they are: pandas frames and matplotlib figures.

The two names stand for classes of libraries that are slow to import. A type checker sees the
classes themselves; at run time the names recognise them without importing anything.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame as Table
else:

    class _Recognised(type):
        """Recognises the class of a library, if that is imported, in ``isinstance``."""

        def __instancecheck__(cls, value: object) -> bool:
            return cls.__subclasscheck__(type(value))

        def __subclasscheck__(cls, kind: type) -> bool:
            module = sys.modules.get(cls.library)
            known = getattr(module, cls.name, None)
            return type.__subclasscheck__(cls, kind) or (
                known is not None and issubclass(kind, known)
            )

    class Table(metaclass=_Recognised):
        """A pandas DataFrame, a row per unit; `with_info` attaches title, units and the like."""

        library, name = "pandas", "DataFrame"

    class Figure(metaclass=_Recognised):
        """A matplotlib figure."""

        library, name = "matplotlib.figure", "Figure"


def lend_table(table: Table) -> Table:
    """Return a copy that a reader may write to, its columns in memory one after the other.

    A table that was just computed may lie in memory in other ways than one from the store. The
    sums of its columns would then differ in their last bit.
    """
    return table.copy(deep=True)


__all__ = ["Figure", "Table", "lend_table"]
