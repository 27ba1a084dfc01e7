"""Compare methods by their ranks."""
