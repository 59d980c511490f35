"""What users see in the browser: the viser scene, the panels, the pages."""
