"""The calibration engine: poses, camera, board, calibration, search, guidance.
It has no screen, thread or file access, and imports only from within itself."""
