"""Building blocks of every page: server, scene in the browser, controls, help, theme."""
