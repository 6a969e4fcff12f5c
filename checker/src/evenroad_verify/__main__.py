"""``python -m evenroad_verify``: the command ``evenroad-verify``."""

import sys

from evenroad_verify.command import main

sys.exit(main())
