"""Lessons as values, and how they are read from the files that teachers write."""
