"""Poses, the camera model, the board, and a pose taken apart into four steps."""
