"""Texts of both exercise pages; the rest is in `practice_texts` and `trial_texts`."""

BROKEN = "This page met an error and stands still. Reload it to go on."
STANDS_STILL = "a tab's page could not be drawn anew; it stands still until it is reloaded"
