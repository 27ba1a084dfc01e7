"""A static gallery of runs; the guides, and how mkdocs builds them with the reference."""
