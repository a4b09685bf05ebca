"""The command-line program, as ``vtex`` and as ``python -m vtex``."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import sysconfig

from vtex import _vtex


def main() -> int:
    """Run the command-line program with the arguments of this process.

    Returns
    -------
    int
        Exit code: 0 = done, 1 = failed, 2 = wrong usage, 130 = interrupted.
    """
    # Python's handler waits until the program returns. The program has its own handler while it works.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _open_closed_streams()
    # Inkscape and GIMP start the script.
    script = shutil.which("vtex", path=sysconfig.get_path("scripts"))
    return _vtex.run_program(["vtex", *sys.argv[1:]], script)


def _open_closed_streams() -> None:
    """Open the null device in place of closed standard streams, as programs in Rust do.

    Otherwise the next file that is opened gets the number of a standard stream.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)


if __name__ == "__main__":
    sys.exit(main())
