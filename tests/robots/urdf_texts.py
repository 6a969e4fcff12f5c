"""Small URDFs for tests, written out of pieces."""

SPHERE = "<collision><geometry><sphere radius='0.05'/></geometry></collision>"
LIMIT = "<limit lower='-1' upper='1' velocity='2' effort='1'/>"


def link(name, body=SPHERE):
    return f"<link name='{name}'>{body}</link>"


def joint(name, parent, child, kind="revolute", inside=LIMIT, xyz="0 0 0.3", axis="0 1 0"):
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>"
        f"<origin xyz='{xyz}'/><axis xyz='{axis}'/>{inside}</joint>"
    )


def urdf(*parts, name="arm"):
    return f"<robot name='{name}'>{''.join(parts)}</robot>"


def two_joints(last_body=SPHERE):
    """base -a-> upper -b-> lower."""
    return urdf(
        link("base"), link("upper"), link("lower", last_body), joint("a", "base", "upper"), joint("b", "upper", "lower")
    )


def write(folder, text, name="arm.urdf"):
    path = folder / name
    path.write_text(text)
    return path
