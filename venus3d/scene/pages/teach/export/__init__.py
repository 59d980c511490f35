"""Exports lessons and targets: an offline page, a sheet, an animation."""
