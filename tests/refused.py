"""What is refused, and what is said of it."""

import pytest


def refused(error, says, call, *arguments, **keywords):
    """See that a call raises the error, and that its text matches where one is given."""
    with pytest.raises(error, match=says or None):
        call(*arguments, **keywords)
