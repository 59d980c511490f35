"""What pages print and log in the terminal, which speaks English whatever the page does."""

PORT_TAKEN = "Port {port} is taken; using {taken}."
FAILED_ONCE = "venus3d: %s; if it happens again, this is not repeated."
CALLBACK_FAILED = "what was asked for on a page could not be done"
DRAWING_FAILED = "drawing a page failed, so it is reloaded"
DRAWING_ANEW_FAILED = "a page could not be reloaded; it is tried again"
TAB_STOPPED = "a tab's page could not be redrawn; it has stopped until it is reloaded"
STEPS_FAILED = "the pictures of the four steps could not be drawn"
PAGE_ANNOUNCED = "{title}: {url}   (Ctrl-C ends it)"
FROM_ELSEWHERE = "On other machines: {url}   ({reach})"
WITH_TOKEN = "whoever has this address, with its token, can open the page"
WITHOUT_TOKEN = "anybody on the network can open it, without a password"
SOURCE_GONE = "{name}: no pictures since {since}; it is opened again until they come."
SOURCE_TRIED = "{name}: opening it again, try {tries}: {reason}"
SOURCE_BACK = "{name}: pictures again, after {seconds:.1f} s."
SOURCE_OTHER_SIZE = (
    "{name}: the pictures are now {now} px, not {was}; set the source back, or begin a new session."
)
