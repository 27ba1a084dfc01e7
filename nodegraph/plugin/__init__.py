"""Plugins: hook specifications, loading, guards against faulty hooks, and the registry of nodes."""
