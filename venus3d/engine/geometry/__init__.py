"""Poses, the camera model, the board, and the decomposition of a pose into four steps."""
