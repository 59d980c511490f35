"""A guided calibration from the first frame to convergence, and the words that guide."""
