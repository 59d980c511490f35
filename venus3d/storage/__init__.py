"""What goes to disk: results, camera files, the printable board."""
