"""The second monitor: a page without controls, to be read at two metres."""
