"""The second monitor: a page that shows and cannot be acted on, to be read at two metres."""
