"""The guard of readers: each name of a file is used, harmless, refused or noted, at every level."""

import time
from xml.etree.ElementTree import Element, SubElement, fromstring

import pytest

from evenroad._understood import Kind, require_understood
from evenroad.errors import UnknownName

LEAF = Kind(("size",), harmless={"colour"}, refused={"padding": "it is an option of load_robot"})
TREE = Kind(("name",), {"box": LEAF, "group": Kind(("name",), {"box": LEAF})}, harmless={"plugin"})


def noted(document, kind=TREE):
    notes = []
    require_understood(document, kind, "file", notes)
    return notes


def test_what_is_known_passes_without_a_note():
    known = '<tree name="a" xmlns:x="y"><plugin any="1"><box none="2"/></plugin><box size="1" colour="red"/></tree>'
    assert noted(fromstring(known)) == []
    assert noted({"name": "a", "plugin": {"any": {"none": 1}}, "box": [{"size": 1, "colour": "red"}]}) == []


@pytest.mark.parametrize(
    ("document", "says"),
    [
        (fromstring('<tree nam="a"/>'), r"attribute of <tree> in file: 'nam'; did you mean 'name'\?"),
        (fromstring('<tree><group name="g"><boxx/></group></tree>'), "element of <group> 'g' in file: 'boxx'; did you"),
        (fromstring('<tree name="t"><box sizes="1"/></tree>'), "attribute of <box> of <tree> 't' in file: 'sizes'"),
        ({"group": {"name": "g", "boxes": []}}, "key of group 'g' in file: 'boxes'; did you mean 'box'"),
        ({"group": [{"box": {"siz": 1}}]}, "key of box of group in file: 'siz'; did you mean 'size'"),
    ],
)
def test_a_misspelt_name_is_refused_with_a_hint_even_where_others_are_noted(document, says):
    with pytest.raises(UnknownName, match=says):
        noted(document)


@pytest.mark.parametrize("document", [fromstring('<tree><box padding="1"/></tree>'), {"box": [{"padding": 1}]}])
def test_a_listed_name_is_refused_with_what_to_do_in_its_place(document):
    with pytest.raises(UnknownName, match="'padding' of box|'padding' of <box>") as caught:
        noted(document)
    assert "is not taken: it is an option of load_robot" in str(caught.value)


def test_other_names_are_counted_in_one_note_or_refused_where_there_are_no_notes():
    tree = fromstring('<tree><box mass="1"/><box mass="2"/><wheel/></tree>')
    (note,) = noted(tree)
    assert "attribute 'mass' of <box> of <tree> (2 times)" in note
    assert "<wheel> of <tree>" in note
    with pytest.raises(UnknownName, match="unknown element of <tree> in file: 'wheel'; known: box, group"):
        require_understood(tree, TREE, "file")


def test_names_of_the_files_own_are_not_looked_at_but_what_is_below_them_is():
    joints = Kind(parts={"limits": Kind(each=Kind(("max",)))})
    assert noted({"limits": {"maxx": {"max": 1}}}, joints) == []
    with pytest.raises(UnknownName, match="key of elbow of limits in file: 'maxi'"):
        noted({"limits": {"elbow": {"maxi": 1}}}, joints)


def test_the_time_is_linear_in_the_number_of_unknown_names():
    def seconds(count):
        root = Element("tree")
        for number in range(count):
            SubElement(root, f"wheel-of-{number:06d}", {f"rim{number:06d}": "1"})
        begin = time.process_time()
        (note,) = noted(root)
        assert f"and {count - 6} more" in note
        return time.process_time() - begin

    seconds(2000)
    assert seconds(40_000) < 40 * seconds(4000)
