"""The one family of errors that is meant for a person.

Everything a user can get wrong ends in a `VenusError` whose text is one sentence that names the
cause and the cure. Programming mistakes keep Python's own exceptions.
"""


class VenusError(Exception):
    """A mistake that the user can mend; the text says how."""


class BoardError(VenusError):
    """Board options that make no board."""


class CalibrationError(VenusError):
    """Observations that do not determine a camera."""


class PoseError(VenusError):
    """Numbers that are no pose."""


class SourceError(VenusError):
    """A source that cannot be opened or read."""


class StorageError(VenusError):
    """A file that cannot be written or read back."""
