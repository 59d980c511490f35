"""Shared by threads: the one-slot box, signals, latency."""
