"""What the guided calibration prints and logs in the terminal, which speaks English."""

VIEWER_TITLE = "Viewer"
REPLAY_TITLE = "Recorded session"
HAND_TOO_FAR = "The simulated hand did not come near enough to its target; lower --overlap."
SOURCE_BROKE = "Reading the source failed: {error}"
NOT_SAVED_LOG = "venus3d: a result could not be saved"
FLOW = (
    "{came:.1f} pictures/s come, {searched:.1f} are searched, {sent:.1f} are sent, {age:.0f} ms "
    "old; of {all} so far {skipped:.0%} were not searched and {damaged} were damaged."
)
