"""Self-contained HTML documents: a calibration's report, and an existing camera's verification.
They are files, so they speak English, as the command line does. One file each, no script, nothing
loaded from elsewhere; the browser's print command makes the PDF."""
