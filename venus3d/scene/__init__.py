"""What is seen: shapes, the viser view, the offscreen projections, the panels."""
