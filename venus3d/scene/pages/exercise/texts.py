"""Texts of both exercise pages; the rest is in `practice_texts` and `trial_texts`."""

BROKEN = "This page has stopped after an error. Reload it to continue."
STANDS_STILL = "a tab's page could not be redrawn; it has stopped until it is reloaded"
