"""Audits: whether each step of a run gives the same result when it is called again."""
