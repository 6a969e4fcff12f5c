"""A robot whose joints turn, slide and follow others, with balls for links, beside a post."""

BALL = '<collision><origin xyz="{}"/><geometry><sphere radius="0.05"/></geometry></collision>'
LIMIT = '<limit lower="-3" upper="3"/>'
URDF = f"""<robot name="tree">
  <link name="base"/>
  <link name="a">{BALL.format("0.1 0.2 0")}</link>
  <link name="b">{BALL.format("0 0.1 0.3")}</link>
  <link name="c">{BALL.format("0.2 -0.1 0.1")}{BALL.format("0.3 0.2 0")}</link>
  <link name="d">{BALL.format("-0.2 0.3 0.1")}</link>
  <joint name="A" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/>
    <axis xyz="0 0.6 0.8"/>{LIMIT}</joint>
  <joint name="B" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0.2 0 0.1"/>
    <axis xyz="1 0 0"/>{LIMIT}</joint>
  <joint name="C" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0 0.3 0" rpy="0 1 0"/>
    <axis xyz="0 1 0"/>{LIMIT}</joint>
  <joint name="D" type="revolute"><parent link="a"/><child link="d"/><origin xyz="-0.1 0.1 0" rpy="0 0 2"/>
    <axis xyz="0.8 0 0.6"/><mimic joint="C" multiplier="-1.5" offset="0.2"/><limit lower="-6" upper="6"/></joint>
</robot>
"""
POST = "obstacles:\n  post: {shape: sphere, radius: 0.05, xyz: [0.4, 0.3, 0.2]}\n"
