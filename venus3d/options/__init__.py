"""What a person can choose, as frozen values that the command line fills and the rooms read.

How options are parsed is left to tyro, what is done with them to `app` and `cli`.
"""

from venus3d.options.common import BoardOptions, LimitOptions, Switch, check_range, image_size_of
from venus3d.options.guide import GuideOptions
from venus3d.options.practice import PracticeOptions
from venus3d.options.teach import TeachOptions

__all__ = [
    "BoardOptions",
    "GuideOptions",
    "LimitOptions",
    "PracticeOptions",
    "Switch",
    "TeachOptions",
    "check_range",
    "image_size_of",
]
