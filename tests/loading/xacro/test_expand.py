"""Expanding a xacro: properties, macros, conditions, includes; and what files may not do."""

import os
import time

import pytest

from evenroad.errors import BrokenFile, EvenroadError, UnknownName
from evenroad.robot import load_robot

from .files import read, xacro

CELL = """
<xacro:arg name="side" default="left"/>
<xacro:property name="length" value="${2 * radius}"/>
<xacro:property name="radius" value="0.25"/>
<xacro:property name="sign" value="${-1 if '$(arg side)' == 'left' else 1}"/>
<xacro:macro name="body" params="name mass:=${pi} parent:='base link' *origin **shape">
  <link name="${name}_$(arg side)">
    <xacro:insert_block name="origin"/>
    <geometry parent="${parent}"><xacro:insert_block name="shape"/></geometry>
  </link>
  <xacro:property name="last" value="${mass}" scope="parent"/>
</xacro:macro>
<xacro:body name="arm"><origin xyz="0 0 ${sign * length}"/>
<shape><box size="1"/><sphere radius="${radius}"/></shape></xacro:body>
<xacro:unless value="${last == 0}"><mass value="${last}" text="$${last} $(eval 1 + 1)"/></xacro:unless>
<xacro:if value="false"><never/></xacro:if>
"""


def test_a_file_of_the_usual_style_is_expanded(tmp_path):
    root = read(xacro(tmp_path, CELL), side="left")
    link, mass = root
    assert link.attrib == {"name": "arm_left"}
    assert link.find("origin").attrib == {"xyz": "0 0 -0.5"}
    assert link.find("geometry").attrib == {"parent": "base link"}
    assert [(each.tag, dict(each.attrib)) for each in link.find("geometry")] == [
        ("box", {"size": "1"}),
        ("sphere", {"radius": "0.25"}),
    ]
    assert mass.attrib == {"value": "3.141592653589793", "text": "${last} 2"}
    assert read(xacro(tmp_path, CELL), side="right")[0].find("origin").get("xyz") == "0 0 0.5"


def test_a_macro_that_calls_itself_counts_down(tmp_path):
    loop = (
        '<xacro:macro name="m" params="n"><a v="${n}"/><xacro:if value="${n &gt; 0}"><xacro:m n="${n - 1}"/></xacro:if>'
    )
    assert len(read(xacro(tmp_path, f'{loop}</xacro:macro><xacro:m n="100"/>'))) == 101


def test_names_of_an_include_stand_behind_its_own(tmp_path):
    xacro(tmp_path, '<xacro:property name="k" value="7"/><xacro:macro name="m"><b v="${k}"/></xacro:macro>', "in.xacro")
    root = read(xacro(tmp_path, '<xacro:include filename="in.xacro" ns="n"/><xacro:n.m/><a v="${n.k}"/>'))
    assert [each.get("v") for each in root] == ["7", "7"]
    with pytest.raises(BrokenFile, match="unknown name 'k'"):
        read(xacro(tmp_path, '<xacro:include filename="in.xacro" ns="n"/><a v="${k}"/>'))


LOADED = "<a v=\"${xacro.load_yaml('%s')['low']}\"/>"


def test_yaml_is_read_with_its_units_where_the_package_is_and_nowhere_else(tmp_path):
    package, urdf = tmp_path / "arm", tmp_path / "arm" / "urdf"
    urdf.mkdir(parents=True)
    (tmp_path / "own.yaml").write_text("low: 1")
    (package / "limits.yaml").write_text("low: !degrees 180\nmade: 2020-01-01\n")
    (urdf / "own.yaml").symlink_to(tmp_path / "own.yaml")
    for name in ("../limits.yaml", "../../own.yaml", "own.yaml", str(tmp_path / "own.yaml"), "/etc/passwd"):
        with pytest.raises(BrokenFile, match=r"load_yaml reads within the folders .*--package NAME=FOLDER"):
            read(xacro(urdf, LOADED % name))
    (package / "package.xml").write_text("<package><name>arm</name></package>")
    assert read(xacro(urdf, LOADED % "../limits.yaml"))[0].get("v") == "3.141592653589793"
    with pytest.raises(BrokenFile, match="load_yaml reads within"):
        read(xacro(urdf, LOADED % "../../own.yaml"))
    # What the user names, and packages that are found, are read; a folder that merely has the name is not.
    assert read(xacro(urdf, LOADED % "../../own.yaml"), packages={"all": str(tmp_path)})[0].get("v") == "1"
    other = tmp_path / "other"
    other.mkdir()
    (other / "own.yaml").write_text("low: 2")
    with pytest.raises(BrokenFile, match="load_yaml reads within"):
        read(xacro(urdf, LOADED % "$(find other)/own.yaml"), lambda name: tmp_path / name)
    (other / "package.xml").write_text("<package><name>other</name></package>")
    assert read(xacro(urdf, LOADED % "$(find other)/own.yaml"), lambda name: tmp_path / name)[0].get("v") == "2"


def test_a_workspace_that_links_its_files_to_their_sources_is_read(tmp_path):
    source, share = tmp_path / "src" / "arm", tmp_path / "install" / "arm"
    source.mkdir(parents=True)
    share.mkdir(parents=True)
    (source / "package.xml").write_text("<package><name>arm</name></package>")
    (source / "limits.yaml").write_text("low: 3")
    for name in ("package.xml", "limits.yaml"):
        (share / name).symlink_to(source / name)
    assert read(xacro(share, LOADED % "limits.yaml"))[0].get("v") == "3"


REFUSED = [
    ("<xacro:macro name='m'><xacro:m/></xacro:macro><xacro:m/>", "nested too deep"),
    ("<xacro:include filename='a.xacro'/>", "nested too deep"),
    ("<xacro:include filename='/etc/passwd'/>", "not XML"),
    ("<xacro:include filename='/dev/zero'/>", "a device or a pipe"),
    ("<xacro:include filename='pipe'/>", "a device or a pipe"),
    ("<xacro:include filename='none*'/>", "is missing"),
    ("<xacro:property name='__class__' value='1'/>", "no name of a property"),
    ("<xacro:property name='a' valu='1'/>", "did you mean 'value'"),
    ("<xacro:property name='a' value='${a}'/><b v='${a}'/>", "defined by itself"),
    ("<xacro:nomacro/>", "unknown macro 'nomacro'"),
    ("<xacro:if value='maybe'/>", "neither true nor false"),
    ("<a v='$(find ../up)'/>", "no name of a package"),
    ("<a v='$(find none)'/>", "--package none=FOLDER"),
    ("<a v='$(exec ls)'/>", "unknown command"),
    ("<a v='${1'/>", "does not end"),
    ("<a v='${xacro.fatal(\"no such arm\")}'/>", "the file says: no such arm"),
    ("<xacro:macro name='m' params='" + "a:=${" * 50000 + "'/>", "more than 10000 characters"),
    ("<a>" * 2000 + "</a>" * 2000, "nested too deep"),
]


@pytest.mark.parametrize(("content", "said"), REFUSED, ids=[said for _, said in REFUSED])
def test_what_cannot_be_expanded_is_refused_in_one_line(tmp_path, content, said):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(BrokenFile, match=f"cannot be expanded: .*{said}"):
        read(xacro(tmp_path, content))


def _doubled(first, next_one):
    return f"<xacro:property name='a0' value='{first}'/>" + "".join(
        f"<xacro:property name='a{i}' value='{next_one.format(i - 1)}'/>" for i in range(1, 60)
    )


GROWING = {
    "macros": "<xacro:macro name='m0'><a/></xacro:macro>"
    + "".join(f"<xacro:macro name='m{i}'>{2 * f'<xacro:m{i - 1}/>'}</xacro:macro>" for i in range(1, 60))
    + "<xacro:m59/>",
    "texts": _doubled("x", "${{a{0}}}${{a{0}}}") + "<b v='${a59}'/>",
    "lists": _doubled("${[0, 0]}", "${{[a{0}, a{0}]}}") + "<b v='${a59}'/>",
    "elements": "<a/>" * 150_000,
}


@pytest.mark.parametrize("kind", GROWING)
def test_what_doubles_and_doubles_is_refused_soon(tmp_path, kind):
    path = xacro(tmp_path, GROWING[kind])
    began = time.process_time()
    with pytest.raises(BrokenFile, match=r"more than \d+ (steps|characters or entries)"):
        read(path)
    assert time.process_time() - began < 5.0


CODE = "${[c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close'][0].__init__.__globals__}"


@pytest.mark.parametrize("name", ["arm.xacro", "arm.urdf"])
def test_a_robot_whose_size_is_code_is_refused(tmp_path, name):
    link = f'<link name="a"><collision><geometry><box size="{CODE} 1 1"/></geometry></collision></link>'
    with pytest.raises(EvenroadError, match="has no attribute '__class__'"):
        load_robot(xacro(tmp_path, '<xacro:property name="p" value="1"/>' + link, name))


def test_an_argument_of_a_part_that_is_left_out_is_known(tmp_path):
    path = xacro(tmp_path, '<xacro:if value="0"><a v="$(arg tool)"/></xacro:if>')
    assert list(read(path, tool="gripper")) == []
    with pytest.raises(UnknownName, match="'tol'; did you mean 'tool'"):
        read(path, tol="gripper")
