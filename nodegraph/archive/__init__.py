"""A run as one file, for a repository."""
