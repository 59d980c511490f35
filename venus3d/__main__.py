"""The program `venus3d`, also as `python -m venus3d`."""

import sys


def run() -> int:
    """Run one command; returns the exit code."""
    try:
        # Takes a second, in which Ctrl-C is a person's wish as later.
        from venus3d.cli import main
    except KeyboardInterrupt:
        print("venus3d: stopped.", file=sys.stderr)
        return 130
    return main()


if __name__ == "__main__":
    sys.exit(run())
