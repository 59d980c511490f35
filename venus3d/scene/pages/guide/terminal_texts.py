"""What the guided calibration prints and logs in the terminal, which speaks English."""

VIEWER_TITLE = "Viewer"
REPLAY_TITLE = "Recorded session"
NOT_CONVERGED = "Not converged after {views}: {why} Not settled: {names}."
MAX_VIEWS = "--max-views is reached; allow more."
SOURCE_ENDED = "The source has ended; take more pictures."
STOPPED = "It was stopped."
HAND_TOO_FAR = "The simulated hand did not come near enough to its target; lower --overlap."
NO_TARGET = "No next pose was found for the simulated hand."
SOURCE_BROKE = "Reading the source failed: {error}"
NOT_SAVED_LOG = "venus3d: a result could not be saved"
FLOW = (
    "{came:.1f} pictures/s come, {searched:.1f} are searched, {sent:.1f} are sent, {age:.0f} ms "
    "old; of {all} so far {skipped:.0%} were not searched and {damaged} were damaged."
)
