"""A guided calibration from the first frame to convergence, and its instructions."""
