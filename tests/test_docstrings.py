"""What is public says what it takes, gives and raises, and shows it by an example that runs here."""

import doctest
import importlib
import inspect
import re
from types import ModuleType

import pytest

import evenroad as er

MODULES = ("constraints", "qmc", "spaces", "io", "testing")
"""Modules of the root whose functions and classes are for users; of `errors` the classes are, by their names alone."""

OF_PLANNERS = {
    *("apart", "connect", "connect_anew", "may_connect", "shorten", "explain_start", "with_bodies"),
    *("bound", "residual", "derivative", "bend", "off", "words"),
    *("solve", "validate", "motion_certified", "path_clearance", "nearest_along", "fingerprint"),
}
"""Methods by which planners and files ask a world; users have `result` and `er.plan` for them."""

NOT_YET = {*("Roadmap", "Status", "CartesianLine", "load_roadmap")}
"""Names of the root that are about to move or to go."""


def _ours(thing):
    return getattr(thing, "__module__", "").startswith("evenroad")


def _public():
    """Yield name and object of every public function, class and method, once."""
    homes = [("er", er, [name for name in er.__all__ if name not in NOT_YET])]
    for name in MODULES:
        module = importlib.import_module(f"evenroad.{name}")
        homes.append((f"er.{name}", module, [each for each in vars(module) if not each.startswith("_")]))
    seen = set()
    for home, module, names in homes:
        for name in names:
            thing = getattr(module, name)
            is_public = inspect.isclass(thing) or inspect.isfunction(thing)
            if not is_public or not _ours(thing) or id(thing) in seen or _is_helper(module, thing):
                continue
            seen.add(id(thing))
            yield f"{home}.{name}", thing
            for member in dir(thing) if inspect.isclass(thing) else ():
                method = inspect.getattr_static(thing, member)
                method = getattr(method, "__func__", method)
                if member.startswith(("_", "test_")) or member in OF_PLANNERS or id(method) in seen:
                    continue
                if inspect.isfunction(method) and _ours(method):
                    seen.add(id(method))
                    yield f"{home}.{name}.{member}", method


def _is_helper(module, thing):
    """Return whether a module only uses a thing: what it hands on it imports ``as`` itself."""
    handed_on = re.search(rf"import {thing.__name__} as {thing.__name__}\b", inspect.getsource(module))
    return module is not er and thing.__module__ != module.__name__ and not handed_on


PUBLIC = dict(_public())


def _parameters(thing):
    names = inspect.signature(thing).parameters
    return [name for name in names if name not in ("self", "cls")]


def _text(name, thing):
    """Return the docstring: of a method that implements one of a base class, the base's where that says more."""
    texts = [inspect.getdoc(thing) or ""]
    owner, _, member = name.rpartition(".")
    if inspect.isclass(PUBLIC.get(owner)):
        bases = [vars(each)[member] for each in PUBLIC[owner].__mro__ if member in vars(each)]
        texts += [(each.__doc__ and inspect.cleandoc(each.__doc__)) or "" for each in bases if each is not thing]
    return max(texts, key=lambda text: text.count("\n---"))


def _needs(name, thing):
    """Yield the sections that a docstring must have."""
    inherits = inspect.isclass(thing) and "__init__" not in vars(thing)
    if not _parameters(thing) or inherits or name == "er.spaces.Space":
        return
    yield "Attributes" if name in ("er.Trajectory", "er.PlanResult") else "Parameters"
    if inspect.isfunction(thing) and inspect.signature(thing).return_annotation not in (None, "None"):
        yield "Returns"
    yield "Examples"


def test_there_are_as_many_as_one_thinks():
    assert len(PUBLIC) > 90


@pytest.mark.parametrize("name", PUBLIC)
def test_it_says_what_it_takes_gives_and_shows(name):
    text = _text(name, PUBLIC[name])
    assert text, "it has no docstring"
    lacking = [each for each in _needs(name, PUBLIC[name]) if not re.search(rf"^{each}\n-+$", text, re.M)]
    assert not lacking
    inline = re.search(r"\bRaises [A-Z]\w+|; [A-Z]\w*(Value|Name|File|Available) (if|for)\b", text)
    assert not inline, "errors have a section of their own"


@pytest.mark.parametrize("name", PUBLIC)
def test_it_names_all_that_it_takes(name):
    text = _text(name, PUBLIC[name])
    section = re.search(r"^(?:Parameters|Attributes)\n-+\n(.*?)(?:\n\n[A-Z][a-z]+\n-+|\Z)", text, re.M | re.S)
    if section is None:
        return
    lines = [line for line in section[1].split("\n") if line and not line.startswith(" ")]
    said = {each.strip().lstrip("*") for line in lines for each in line.partition(" : ")[0].split(",")}
    taken = {each for each in _parameters(PUBLIC[name]) if not each.startswith("_")}
    assert taken - {"given", "named", "guessed"} <= said


WITH_EXAMPLES = [name for name, thing in PUBLIC.items() if ">>>" in (thing.__doc__ or "")]


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_its_example_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    example = doctest.DocTestParser().get_doctest(inspect.getdoc(PUBLIC[name]), {}, name, None, 0)
    said = []
    doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(example, out=said.append)
    assert not said, "".join(said)


def test_every_error_says_when_it_is_raised():
    errors = [each for each in vars(er.errors).values() if inspect.isclass(each) and issubclass(each, Exception)]
    assert len(errors) == 8
    assert all(len(each.__doc__) > 30 for each in errors)


def test_modules_of_the_root_say_what_they_are():
    modules = [getattr(er, name) for name in er.__all__ if isinstance(getattr(er, name), ModuleType)]
    assert all(each.__doc__ for each in modules)
