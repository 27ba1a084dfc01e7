"""Recordings, models, marker sets and meshes in files, but for those that are text or GLB."""
