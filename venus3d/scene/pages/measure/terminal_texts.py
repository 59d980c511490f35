"""What `venus3d measure` prints."""

TITLE = "Measure"
UNCERTAIN = (
    "{name} does not hold the covariance of its camera, so the ± of a length takes the camera as "
    "exactly known; a result.json holds it."
)
