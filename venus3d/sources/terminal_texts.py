"""What is printed about a live source."""

SOURCE_GONE = "{name}: no pictures since {since}; it is opened again until they come."
SOURCE_TRIED = "{name}: opening it again, try {tries}: {reason}"
SOURCE_BACK = "{name}: pictures again, after {seconds:.1f} s."
SOURCE_OTHER_SIZE = (
    "{name}: the pictures are now {now} px, not {was}; set the source back, or begin a new session."
)
