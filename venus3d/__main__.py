"""`python -m venus3d` is the same as `venus3d`."""

import sys

from venus3d.cli import main

sys.exit(main())
