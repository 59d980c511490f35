"""What `venus3d measure` prints."""

TITLE = "Measure"
UNCERTAIN = (
    "{name} does not say how well the camera is known; the ± of a length leaves that out. A "
    "result.json has it."
)
