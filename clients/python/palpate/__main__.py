"""The program ``palpate`` in this process."""

import sys


def main() -> int:
    """Runs the program with the arguments of the process; returns its exit code."""
    from ._native import main as program

    return program(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
