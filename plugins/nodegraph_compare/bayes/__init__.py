"""Compare methods by probabilities."""
