"""What the engine knows, made visible: uncertainty, captured views, the search."""
