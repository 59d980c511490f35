"""What reading raises of content that is not as a program wrote it."""

from __future__ import annotations

DAMAGED = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
"""A value that is missing, of another type, or impossible."""
