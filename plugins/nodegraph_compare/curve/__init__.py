"""Compare methods by curves over a number."""
