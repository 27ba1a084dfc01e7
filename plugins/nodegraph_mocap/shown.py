"""How tables and figures appear, and how they are kept."""
