"""The command `mmxrt`: the same program as the binary, without an interpreter's part in it."""

import sys

from . import _native


def main() -> int:
    """Runs the command line; its exit code."""
    return _native.command(["mmxrt", *sys.argv[1:]])
