"""The program ``opm``, which comes with the package: ``opm``, or ``python -m opm_kinematics``."""

import signal
import sys

from ._native import command

__all__ = ["main"]


def main() -> int:
    """Run the command line and return the exit status."""
    # Python only notes down that Ctrl-C was pressed, until the program returns: here it ends it at once, and
    # where there is something to be put in order first, the program says so itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command(["opm", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
