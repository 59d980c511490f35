"""Planning of the board's next pose: limits, costs, searches, forecast."""
