"""Displays of what the engine knows: uncertainty, captured views, the search."""
