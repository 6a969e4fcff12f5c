"""Adapters without what they adapt: the extra is named."""

import importlib
import sys

import pytest

from evenroad.errors import NotAvailable


@pytest.mark.parametrize(("name", "extra"), [("ompl", "ompl"), ("klampt", "klampt"), ("mujoco", "mjcf")])
def test_an_adapter_names_its_extra(name, extra, monkeypatch):
    for module in [module for module in sys.modules if module.split(".")[0] == name]:
        monkeypatch.delitem(sys.modules, module)
    for module in [module for module in sys.modules if module.startswith("evenroad.adapters")]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(NotAvailable, match=rf"pip install 'evenroad\[{extra}\]'"):
        importlib.import_module(f"evenroad.adapters.{name}")
