"""``python -m evenroad``: the command."""

from evenroad.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
