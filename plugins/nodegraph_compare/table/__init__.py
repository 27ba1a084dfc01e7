"""Compare methods by a table of means."""
