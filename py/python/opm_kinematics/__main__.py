"""The program ``opm``, which comes with the package: ``opm``, or ``python -m opm_kinematics``."""

import signal
import sys

from ._native import command

__all__ = ["main"]


def main() -> int:
    """Run the command line and return the exit status."""
    # By default Python only records Ctrl-C until the program returns. Here Ctrl-C ends it at once; where something
    # has to be put in order first, the program handles the signal itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command(["opm", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
