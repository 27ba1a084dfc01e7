"""Recordings and weights in files of text: which form it is, and a reader for each."""
