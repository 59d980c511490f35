"""What every page is made of: server, scene in the browser, controls, help, theme."""
