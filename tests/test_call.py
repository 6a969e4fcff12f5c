"""A call with arguments that there are not is answered by an error of ours that says which there are."""

import pytest

from evenroad._call import explains_calls
from evenroad.errors import InvalidValue, UnknownName


@explains_calls
def steer(speed, *, angle=0.0):
    return len(speed) + angle


@explains_calls
class Wheel:
    def __init__(self, radius):
        self.radius = radius

    def turned(self, by):
        return by * self.radius


def test_what_is_right_is_done_as_before():
    assert steer([1, 2], angle=1.0) == 3.0
    assert Wheel(2).turned(by=3) == 6
    assert steer.__name__ == "steer"


@pytest.mark.parametrize(("call", "error", "text"), [
    (lambda: steer([1], angel=1), UnknownName, "'angel'; did you mean 'angle'?"),
    (lambda: steer([1], 2), InvalidValue, "called as steer(speed, *, angle): takes 1 positional"),
    (lambda: steer(), InvalidValue, "missing 1 required positional argument: 'speed'"),
    (lambda: steer([1], speed=[2]), InvalidValue, "multiple values for argument 'speed'"),
    (lambda: Wheel(raduis=1), UnknownName, "keyword of Wheel: 'raduis'; did you mean 'radius'"),
    (lambda: Wheel(1).turned(to=1), UnknownName, "keyword of turned: 'to'; known: by"),
])  # fmt: skip
def test_a_wrong_call_is_told_what_there_is(call, error, text):
    with pytest.raises(error) as raised:
        call()
    assert text in str(raised.value)


def test_a_type_error_from_within_stays_what_it_is():
    with pytest.raises(TypeError, match="no len"):
        steer(7)
