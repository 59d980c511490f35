"""The practice page: each trainee brings a board of their own to a target."""
