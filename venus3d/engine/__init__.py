"""The calibration engine: poses, camera, board, calibration, search, guidance.

It knows no screen, no thread and no file, and imports nothing of ours outside itself.
"""
