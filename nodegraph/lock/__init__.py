"""Studies that are frozen in a text file, and verified later."""
