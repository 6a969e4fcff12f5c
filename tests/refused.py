"""What is refused, and what is said of it."""

import pytest


def refused(error, says, call, *arguments, **keywords):
    """See that a call raises the error, whose text matches."""
    with pytest.raises(error, match=says):
        call(*arguments, **keywords)
