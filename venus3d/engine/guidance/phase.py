"""The state of a session."""

from typing import Literal

Phase = Literal["startup", "guiding", "captured", "converged", "finished"]
"""startup: until the first capture; guiding: a target is shown; captured: calibrating and
searching; converged: the parameters have settled; finished: ended by the user or complete."""
