"""What the second monitor prints in the terminal, which speaks English."""

ANNOUNCED = "Second monitor: {url}   (it only shows)"
