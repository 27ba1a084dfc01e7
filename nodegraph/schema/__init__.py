"""A JSON Schema (draft 2020-12) of graph files, with every installed node, for editors.

It accepts whatever the loader accepts, and refuses wrong keys, names, settings and bounds as it
does. What depends on more than one place of a file (types that fit, cycles, unused axes) stays
with the loader.
"""

from nodegraph.schema.file import graph_schema

__all__ = ["graph_schema"]
