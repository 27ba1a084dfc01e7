"""Whether nodes give one answer, whatever the circumstances."""
