"""Errors that are meant for a person.
Every user mistake ends in a `VenusError` whose text is one sentence with the cause and the cure.
Programming mistakes keep Python's own exceptions."""


class VenusError(Exception):
    """A mistake that the user can correct; the text says how."""


class BoardError(VenusError):
    """Board options that do not make a board."""


class CalibrationError(VenusError):
    """Observations that do not determine a camera."""


class PoseError(VenusError):
    """Numbers that do not make a pose."""


class SourceError(VenusError):
    """A source that cannot be opened or read."""


class StorageError(VenusError):
    """A file that cannot be written or read."""
