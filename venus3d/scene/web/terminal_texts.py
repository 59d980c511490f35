"""What pages print and log in the terminal, which speaks English whatever the page does."""

PORT_TAKEN = "Port {port} is taken; using {taken}."
FAILED_ONCE = "venus3d: %s; if it happens again, this is not repeated."
DRAWING_FAILED = "drawing a page failed, so it is reloaded"
DRAWING_ANEW_FAILED = "a page could not be reloaded; it is tried again"
TAB_STOPPED = "a tab's page could not be redrawn; it has stopped until it is reloaded"
STEPS_FAILED = "the pictures of the four steps could not be drawn"
PAGE_ANNOUNCED = "{title}: {url}   (Ctrl-C ends it)"
