"""An arm with masses, as URDF: its joints turn and slide about slanted axes."""

GEOMETRY = '<geometry><sphere radius="0.03"/></geometry>'
JOINTS = [
    ("turn", "revolute", "base", "upper", "0 0 0.3", "0.2 0 0", "0 0 1", ""),
    ("bend", "revolute", "upper", "lower", "0.3 0.05 0.1", "0 0.4 -0.3", "0 0.6 0.8", ""),
    ("slide", "prismatic", "lower", "rail", "0.25 0 0", "0.1 0.2 0.3", "1 0 0", ""),
    ("finger", "revolute", "rail", "finger", "0.1 0.02 0", "0 0 0", "0 1 0", ""),
    (
        "thumb",
        "revolute",
        "rail",
        "thumb",
        "0.1 -0.02 0",
        "0 0 0",
        "0 1 0",
        '<mimic joint="finger" multiplier="-0.5"/>',
    ),
]
EFFORTS = {"turn": 40.0, "bend": 30.0, "slide": 60.0, "finger": 2.0}


def inertial(mass, at, moments):
    xx, yy, zz = moments
    return (
        f'<inertial><origin xyz="{at}" rpy="0.3 -0.2 0.5"/><mass value="{mass}"/>'
        f'<inertia ixx="{xx}" ixy="0.001" ixz="-0.002" iyy="{yy}" iyz="0.0005" izz="{zz}"/></inertial>'
    )


def urdf(mass="2.0"):
    """An arm whose joints turn and slide about slanted axes, and one that follows another."""
    masses = {
        "upper": inertial("3.0", "0.1 0.02 0.05", (0.05, 0.06, 0.04)),
        "lower": inertial(mass, "0.12 -0.03 0.01", (0.03, 0.05, 0.04)),
        "rail": inertial("1.0", "0.05 0 0.02", (0.01, 0.012, 0.011)),
        "finger": inertial("0.3", "0.06 0 0.01", (0.003, 0.004, 0.005)),
        "thumb": inertial("0.2", "0.05 0.01 0", (0.002, 0.003, 0.003)),
    }
    links = "".join(
        f'<link name="{link}">{masses.get(link, "")}<collision>{GEOMETRY}</collision></link>'
        for link in ("base", "upper", "lower", "rail", "finger", "thumb")
    )
    joints = "".join(
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{mimic}'
        f'<limit lower="-2" upper="2" velocity="3" effort="{EFFORTS.get(name, 1.0)}"/></joint>'
        for name, kind, parent, child, xyz, rpy, axis, mimic in JOINTS
    )
    return f'<robot name="slanted">{links}{joints}</robot>'
