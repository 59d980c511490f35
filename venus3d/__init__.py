"""venus3d: guided camera calibration that a person can see."""

__version__ = "0.1.0"
