"""Results -> one HTML file, and the tables and figures beside it."""
