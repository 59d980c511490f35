"""The page on which lengths are measured in a calibrated camera's live picture: the scene seen
through the lens, two clicks on the board's plane, and a cube that stands on it."""
