"""The kinds of boards; what a kind is says `kind`."""
