"""The read-only page of a second monitor: one glance from two metres."""
