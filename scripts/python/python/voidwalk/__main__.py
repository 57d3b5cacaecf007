"""The command line: `voidwalk`, or `python -m voidwalk`."""

from __future__ import annotations

import signal
import sys

from ._voidwalk import command


def main() -> None:
    # The program hears Ctrl-C itself. Python's handler would raise when the program has saved its progress and ended.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(command(["voidwalk", *sys.argv[1:]], [sys.executable or "python3", "-m", "voidwalk"]))


if __name__ == "__main__":
    main()
