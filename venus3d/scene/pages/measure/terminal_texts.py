"""What `venus3d measure` prints."""

TITLE = "Measure"
UNCERTAIN = (
    "{name} does not hold the covariance of its camera, so the ± of a length takes the camera as "
    "exactly known; a result.json holds it."
)
WRONG = (
    "Mind: the board is seen, but not as the camera in {name} would see it, so lengths would be "
    "wrong: the file is of another camera, zoom or focus, or the board is another one. Start again "
    "with the right --camera or --board.*."
)
