"""The overview of a comparison: its verdicts at a glance, and every block behind them."""
