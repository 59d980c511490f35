"""What threads share: the one-slot box, signals, and how soon a waiting thread gets its turn."""
