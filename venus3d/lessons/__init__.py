"""Lessons as values, and their readers for files written by teachers."""
