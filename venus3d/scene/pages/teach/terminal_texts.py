"""What the teaching page prints in the terminal, which speaks English."""

LEAVES_PICTURE = (
    "{lesson!r}, page {page} ({title}): {count} of the board's 4 corners are outside the picture; "
    "move its pose towards the middle, or away from the camera."
)
FOLLOW_ME = (
    "The tab opened first on this machine ({url}) leads the class; all others show what it shows, "
    "until it lets go. Only tabs on this machine may lead."
)
