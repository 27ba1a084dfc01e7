"""Agreement of two methods."""
