"""What the second monitor prints in the terminal, which speaks English."""

ANNOUNCED = "Second monitor: {url}   (it only shows; {open_to})"
THIS_MACHINE = "for this machine"
NETWORK = "anybody on the network can look, without a password"
