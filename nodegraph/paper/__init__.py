"""What a paper needs of a run: what it was, and how far another run agrees with it."""
