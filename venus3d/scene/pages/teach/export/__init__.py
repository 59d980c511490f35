"""Lessons and targets as files: a page that plays offline, a sheet, an animation."""
