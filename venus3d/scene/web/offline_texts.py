"""Texts of every document that is opened without a network."""

from venus3d.languages.texts_module import speak

MADE_WITH = "Made with venus3d"
PAGE_OF = "Page {page} of {pages}"
BACK, ON = "Back", "Next page"
SCENE_TITLE = "The way there"
SCENE_HINT = (
    "Play, stop and go back and forth with the bar below the scene; turn it with the mouse or a "
    "finger."
)
NO_SCRIPT = "This page needs JavaScript for its moving scene; the pictures show the steps without."

speak(__name__)
