"""A page on this machine that shows a graph file as text and as picture, and edits it."""
