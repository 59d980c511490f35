"""Threads and processes: the one-slot box, signals, latency, a process that works."""
