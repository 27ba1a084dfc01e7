"""A static site of what is installed and of runs: gallery, tutorial, reference."""

from nodegraph.site.build import site_files

__all__ = ["site_files"]
