"""Files: results, cameras, the printable board, tables of trials."""
