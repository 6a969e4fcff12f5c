"""An MJCF that stands for more than it holds is refused before MuJoCo reads it."""

import os

import pytest

from evenroad.errors import BrokenFile
from evenroad.loading.mjcf_guard import require_bounded

BODY = '<body name="b"><joint name="j"/><geom type="box" size="1 1 1"/></body>'
TWICE = "<replicate count='100'>" * 3 + "<geom/>" + "</replicate>" * 3


def mjcf(tmp_path, content, name="a.xml"):
    path = tmp_path / name
    path.write_text(f"<mujoco>{content}<worldbody>{BODY}</worldbody></mujoco>")
    return path


def test_what_people_write_passes(tmp_path):
    mjcf(tmp_path, "<asset><mesh file='m.stl'/></asset>", "hand.xml")
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "m.stl").write_bytes(b"")
    models = (
        "<asset><model name='hand' file='hand.xml'/></asset><worldbody><attach model='hand' prefix='l'/></worldbody>"
    )
    size = "<size memory='1G' njmax='8000'/><compiler meshdir='meshes'/>"
    require_bounded(
        mjcf(tmp_path, f"{size}{models}<include file='hand.xml'/><replicate count='20'><geom/></replicate>")
    )
    require_bounded(mjcf(tmp_path, "<worldbody>" + 20_000 * "<geom/>" + "</worldbody>", "many.xml"))
    require_bounded(mjcf(tmp_path, "<include file='many.xml'/>"))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("<replicate count='30000000'><geom/></replicate>", "repetitions"),
        ("<replicate count='1e400'><geom/></replicate>", "repetitions"),
        (TWICE, "repetitions"),
        ("<asset><hfield nrow='100000' ncol='100000'/></asset>", "cells"),
        ("<flexcomp count='3000 3000 300'/>", "cells"),
        ("<size nuserdata='2000000000'/>", "nuserdata of <size> must be at most"),
        ("<include file='a.xml'/>", "itself in it"),
        ("<asset><model file='a.xml'/></asset>", "itself in it"),
        ("<include file='pipe'/>", "a device or a pipe"),
        ("<asset><mesh file='pipe'/></asset>", "a device or a pipe"),
        ("<asset><texture fileright='pipe'/></asset>", "a device or a pipe"),
        ("<compiler assetdir='in'/><asset><mesh file='pipe'/></asset>", "a device or a pipe"),
    ],
)
def test_what_multiplies_or_never_ends_is_refused(tmp_path, content, said):
    (tmp_path / "in").mkdir()
    for folder in (tmp_path, tmp_path / "in"):
        os.mkfifo(folder / "pipe")
    with pytest.raises(BrokenFile, match=said):
        require_bounded(mjcf(tmp_path, content))


def test_models_that_attach_each_other_twice_are_counted(tmp_path):
    for i in range(1, 18):
        part = f"<asset><model name='m' file='m{i - 1}.xml'/></asset>" if i > 1 else ""
        mjcf(tmp_path, part + 2 * "<attach model='m'/>", f"m{i}.xml")
    with pytest.raises(BrokenFile, match="repetitions"):
        require_bounded(tmp_path / "m17.xml")


def test_a_document_type_is_refused_as_mujoco_would_read_another_document(tmp_path):
    path = tmp_path / "a.xml"
    path.write_text(
        f'<!DOCTYPE m [<!ENTITY x "<mujoco><include/></mujoco>">]><mujoco><worldbody>{BODY}</worldbody></mujoco>'
    )
    with pytest.raises(BrokenFile, match="document type"):
        require_bounded(path)
