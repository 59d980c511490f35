"""An address as a QR code for a terminal, to be photographed by a phone."""

from __future__ import annotations

import io
import sys

import segno


def qr_code(address: str) -> str:
    """Lines of half blocks, to be read on a dark or a light background."""
    drawn = io.StringIO()
    segno.make(address, error="l", micro=False).terminal(drawn, border=2, compact=True)
    return drawn.getvalue().rstrip("\n")


def qr_code_if_seen(address: str) -> str:
    """The code if a person looks at a terminal that has its signs; otherwise nothing."""
    encoding = (sys.stdout.encoding or "").lower().replace("-", "")
    return qr_code(address) if sys.stdout.isatty() and encoding == "utf8" else ""
