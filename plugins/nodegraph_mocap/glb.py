"""Heads in GLB files: the binary form of glTF 2.0."""
