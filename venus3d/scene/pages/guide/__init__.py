"""The page of a guided calibration: what stands on it and what a person may do there."""
