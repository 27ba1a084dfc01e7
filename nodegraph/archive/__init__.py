"""Archives: a run packed into one file, for a repository."""
