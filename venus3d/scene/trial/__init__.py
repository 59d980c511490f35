"""The page of a trial with volunteers: one help at a time, and the times."""
