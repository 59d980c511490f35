"""Where the board should go next: limits, costs, searches, forecast."""
