"""What is seen, as named shapes, and pictures of it; knows no browser."""
