"""Write a table as a paper prints it, in the folder of the run."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nodegraph import Files, node
from nodegraph_tables.types import Table

Names = tuple[str, ...]


@node("write.tex")
def write_tex(
    table: Table,
    *,
    rows: Names = (),
    columns: Names = (),
    name: Annotated[str, Field(min_length=1)] = "table",
) -> Files:
    r"""Write a table as LaTeX: methods by groups, each mean with its interval.

    It needs the packages that its first line names. The best of a group is bold, what is not
    certain to be worse italic, as the comparison marks them; where it cannot tell which is best,
    nothing is marked. Numbers have the same decimals, and what is the same throughout stands in the
    caption. A table that is wider or taller than the page is made smaller, or stands sideways if it
    is much wider. A table that is no comparison of methods is written as it is.

    Parameters
    ----------
    table
        Any.
    rows
        Labels that stand down the side, from the outside in. Default: the methods.
    columns
        Labels that stand along the top, from the outside in. Default: those of the groups, the
        outer ones down the side where there are more than six columns. What neither names stands
        in the rows; in the columns, if only rows are named.
    name
        Name of the file, without its suffix.

    Raises
    ------
    ValueError
        If a name is no label of the table, or is given twice, or the table has no row for each
        group and method.
    """
    from nodegraph_tables.info import info_of
    from nodegraph_tables.latex import latex_of

    return Files({f"{name}.tex": latex_of(table, info_of(table).title, rows, columns).encode()})
