"""The page of a guided calibration."""
