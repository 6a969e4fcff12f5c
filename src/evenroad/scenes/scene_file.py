"""Reading a scene from any file: our YAML here, MoveIt's, URDF and glTF by the readers beside."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from evenroad._call import explains_calls
from evenroad._checks import as_file, require_known
from evenroad._native import robot as native
from evenroad._yaml import numbers, read_mapping, require_keys
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.geometry.shapes import PRIMITIVES, PointCloud
from evenroad.loading.find import DATA
from evenroad.robots.held import HeldObject
from evenroad.scenes.entry import Entry
from evenroad.scenes.obstacles import EntryRows
from evenroad.scenes.robot_setup import Said
from evenroad.scenes.scan import allowed_within
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.scenes.scene_entries import POSE, obstacle_of, obstacles_of, region_of
from evenroad.scenes.scene_objects import OBJECT_FILES, objects_of

SCENES = ("box-reach", "box-reach-narrow", "empty", "shelf")
"""Names of the shipped scenes."""
_ROWS_ALONE = frozenset(("obstacles", "name"))
_SECTIONS = ("name", "allowed", "states", "limits", "attach")


def is_scene(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is a scene and no map: by its suffix, or YAML with the key ``obstacles`` or ``world``."""
    if Path(path).suffix.lower() in (".scene", *OBJECT_FILES):
        return True
    try:
        return not {"obstacles", "world"}.isdisjoint(read_mapping(find_scene(path), "scene"))
    except BrokenFile:
        return False


def find_scene(source: str | os.PathLike[str]) -> Path:
    """Return the file of a scene: `source` itself or, where there is no such file, the shipped one of that name."""
    path = as_file("a scene", source, "a scene of shapes, or of a mapping, is er.Scene(...)")
    if not path.is_file() and path.parent == Path() and path.stem in SCENES and path.suffix in ("", ".yaml"):
        return DATA / f"{path.stem}.yaml"
    return path


@explains_calls
def load_scene(source: str | os.PathLike[str]) -> Scene:
    """Return a scene from its file, or a shipped one by its name.

    ::

        obstacles:                                # frame: the robot's root link; metres, radians
          table: {shape: box, size: [1, 1.2, 0.05], xyz: [0.25, 0, -0.025], rpy: [0, 0, 0.1], cell: true}
          ball: {shape: sphere, radius: 0.1, xyz: [0.5, 0, 0.5]}
          post: {shape: cylinder, radius: 0.05, length: 1.0, xyz: [0, 0.6, 0.5]}   # along z; so is a capsule
          scan: {shape: cloud, file: scan.ply, radius: 0.01, seen_at: home, margin: 0.02}
          shelf: {shape: mesh, file: shelf.stl, scale: 0.001, xyz: [0.8, 0, 0]}    # convex: true: its convex hull
          floor: {shape: plane, xyz: [0, 0, -0.8]}                                 # all that is below its x-y plane
          ground: {shape: height_map, file: ground.npy, spacing: 0.05, depth: 1}   # (x, y) heights, solid below
          kitchen: {include: kitchen.glb, xyz: [1, 0, 0]}                          # its objects: kitchen/table, ...
          fridge: {include: fridge.urdf, joints: {door: 1.2}, xyz: [0, 1, 0]}      # its links: fridge/door, ...
        allowed:                                  # contacts that are not tested
          table: [base_link]
          scan:                                   # of a cloud: near the start and the goal, and within a region [m]
            - {link: crate, near_ends: 0.02}
            - {link: crate, within: {shape: box, size: [0.2, 0.2, 0.1], xyz: [0.5, 0, 0]}, grow: 0.01}
        states:                                   # named configurations, joint by joint
          home: {joint_1: 0.0, joint_2: -1.57}
        limits:                                   # ranges to plan in, within the robot's own
          joint_1: [-3.14, 3.14]
        attach:                                   # what the robot holds: a shape in the frame of a link
          crate: {shape: box, size: [0.1, 0.1, 0.2], link: tool0, xyz: [0, 0, 0.1], touches: [wrist_3_link, table]}

    Obstacles may also be a list whose entries have a ``name``, and ``box: {size: [1, 1, 1]}`` stands for ``shape: box,
    size: [1, 1, 1]``.  The length of a capsule is without its caps; ``xyzw: [x, y, z, w]``, a quaternion, may stand for
    ``rpy``; ``cell: true`` marks what belongs to the fixed cell.  Files of
    clouds (:func:`evenroad.geometry.load_cloud`) and meshes (:func:`evenroad.geometry.load_mesh`) are looked for beside
    the scene; points within `margin` of the robot, where it stood when it was `seen_at`, are left out when one plans.
    So are those that a cloud's ``cut`` names, a list of shapes, ``{shape: box, size: [0.1, 0.1, 0.2], xyz: [0.5, 0,
    0.1], grow: 0.01}``, and of what is attached where the robot stands, ``{attached: crate, at: grasp, grow: 0.01}``.
    MoveIt's scenes are read, too (:mod:`evenroad.scenes.moveit_scene`, :mod:`evenroad.scenes.planning_scene`).

    Parameters
    ----------
    source : str or path-like
        A ``.yaml`` as above, a scene of MoveIt, a URDF or glTF whose bodies become obstacles, or ``box-reach``,
        ``box-reach-narrow`` or ``empty``.

    Returns
    -------
    Scene

    Raises
    ------
    BrokenFile
        If the file is missing, not YAML, lacks something, or has a key twice.
    UnknownName
        For a key, a shape or an obstacle that there is not.
    InvalidValue
        For a value of the wrong type or range.

    Examples
    --------
    >>> import evenroad as er
    >>> len(er.load_scene("box-reach").obstacles)
    6
    """
    path = find_scene(source)
    if not path.is_file():
        raise BrokenFile(f"there is no scene file {path}; shipped: {', '.join(f'{name}.yaml' for name in SCENES)}")
    if path.suffix == ".scene":
        # Imported late, as below: scenes of MoveIt are rarer.
        from evenroad.scenes.moveit_scene import read_scene_text

        return read_scene_text(path)
    if path.suffix.lower() in OBJECT_FILES:
        bodies = objects_of(path, {})
        return Scene([Obstacle(name, body) for name, body in bodies.items()], name=path.stem)
    document = read_mapping(path, "scene")
    return _of_document(document, path)


def _of_document(document: Mapping[str, object], path: Path) -> Scene:
    if "obstacles" not in document and "world" in document:
        from evenroad.scenes.planning_scene import read_planning_scene

        return read_planning_scene(document, path)
    return _scene(document, path)


def scene_of(document: Mapping[str, object], name: str) -> Scene:
    """Return the scene that a mapping describes as a file does; errors as :func:`load_scene`."""
    if "obstacles" in document and document.keys() <= _ROWS_ALONE and (rows := _primitives(document)) is not None:
        return Scene(rows, name=str(document.get("name", name)))
    return _of_document({"name": name, **document}, Path("scene"))


def _scene(document: Mapping[str, object], path: Path) -> Scene:
    require_keys(document, ("obstacles",), _SECTIONS, f"the scene {path}")
    root = Entry(document, str(path), path.parent)
    if (rows := _primitives(document)) is not None:
        return Scene(rows, name=str(document.get("name", path.stem)), **_states_and_limits(root))
    groups = {name: obstacles_of(name, entry) for name, entry in _obstacle_entries(root)}
    obstacles = tuple(each for group in groups.values() for each in group)
    groups |= {each.name: (each,) for each in obstacles}
    allowed, parts = _allowed(root, groups)
    attached = []
    for name, entry in root.each("attach", "attached"):
        held, touched = _attached(name, entry, groups)
        attached.append(held)
        allowed.update((name, each.name) for obstacle in touched for each in groups[obstacle])
    said: Said = {**_states_and_limits(root), "attached": tuple(attached)}
    scene = Scene(obstacles, name=str(document.get("name", path.stem)), allowed=frozenset(allowed), **said)
    return _with_parts(scene, parts)


def _primitives(document: Mapping[str, object]) -> EntryRows | None:
    """Return the obstacles of a mapping that holds primitives and their poses alone, in a tenth of the time."""
    entries = document["obstacles"]
    if type(entries) is not dict or not document.keys().isdisjoint(("allowed", "attach")):
        return None
    rows = native.primitive_rows(entries)
    return None if rows is None else EntryRows(rows, tuple(entries))


def _states_and_limits(root: Entry) -> Said:
    """Return the named configurations and the ranges to plan in."""
    states = {
        name: {joint: state.number(joint, what=f"joint {joint!r}") for joint in state.content}
        for name, state in root.each("states", "state")
    }
    limits = {
        joint: _range(value, f"limits of joint {joint!r} in {root.where}")
        for joint, value in root.inside(root.get("limits"), f"limits in {root.where}").content.items()
    }
    return {"states": states, "limits": limits}


def _obstacle_entries(root: Entry) -> Iterator[tuple[str, Entry]]:
    """Yield name and entry of the obstacles of a file: a mapping, or a list whose entries say their own names."""
    obstacles = root.get("obstacles")
    if not isinstance(obstacles, list | tuple):
        for name, entry in root.each("obstacles", "obstacle"):
            yield name, _in_full(entry)
        return
    names = set()
    for i, each in enumerate(obstacles):
        entry = _in_full(root.inside(each, f"obstacle {i} in {root.where}"))
        kind = entry.get("shape") or Path(str(entry.get("include"))).stem
        name = str(entry.get("name", f"{kind} {i}"))
        if name in names:
            raise InvalidValue(f"obstacles in {root.where} must have names of their own, twice: {name!r}")
        names.add(name)
        yield name, entry.without("name").called(f"obstacle {name!r} in {root.where}")


def _in_full(entry: Entry) -> Entry:
    """Return an entry as ``shape: box, size: ...``; ``box: {size: ...}`` and ``sphere: 0.1`` say the same."""
    kinds = [key for key in entry.content if key in PRIMITIVES]
    if "shape" in entry or len(kinds) != 1:
        return entry
    (kind,) = kinds
    given, dimensions, others = entry.get(kind), PRIMITIVES[kind].dimensions, entry.without(kind).content
    if not isinstance(given, Mapping) and len(dimensions) == 1:
        given = {dimensions[0][0]: given}
    inside = entry.inside(given, f"{kind} of {entry.where}").content
    if twice := sorted(inside.keys() & others.keys()):
        raise InvalidValue(f"{entry.where} must say {twice[0]} once, beside its {kind} or in it")
    return replace(entry, content={"shape": kind, **inside, **others})


def _allowed(
    root: Entry, groups: Mapping[str, Sequence[Obstacle]]
) -> tuple[set[tuple[str, str]], list[tuple[str, Entry]]]:
    """Return the contacts that are allowed, and those with a part of a cloud: which, and which part."""
    allowed: set[tuple[str, str]] = set()
    parts = []
    for name, links in root.inside(root.get("allowed"), f"allowed in {root.where}").content.items():
        require_known(f"obstacle in 'allowed' of {root.where}:", name, groups)
        if not isinstance(links, list) or not all(isinstance(link, str | dict) for link in links):
            raise InvalidValue(
                f"allowed contacts of {name!r} in {root.where} must be a list of links, got {shown(links)}"
            )
        for link in links:
            if isinstance(link, str):
                allowed.update((link, each.name) for each in groups[name])
            else:
                parts.append((name, _part(root.inside(link, f"what is allowed to touch {name!r} in {root.where}"))))
    return allowed, parts


def _part(entry: Entry) -> Entry:
    """Return the entry of a contact that is allowed with a part of a cloud, as it should be."""
    entry.require(("link",), ("near_ends", "within", "grow"))
    if not isinstance(entry.get("link"), str) or ("near_ends" in entry) == ("within" in entry):
        raise InvalidValue(
            f"{entry.where} must have a link and one of near_ends and within, got {shown(entry.content)}"
        )
    if "near_ends" in entry and "grow" in entry:
        raise InvalidValue(f"{entry.where} must have grow with within alone: near_ends is a distance itself")
    return entry


def _with_parts(scene: Scene, parts: list[tuple[str, Entry]]) -> Scene:
    """Return a scene with contacts that are allowed with parts of clouds."""
    near = set()
    for cloud, entry in parts:
        link = str(entry.get("link"))
        if not any(isinstance(each.body, PointCloud) for each in scene.obstacles if each.name.startswith(cloud)):
            raise InvalidValue(f"{entry.where} must be a link: a part can be allowed of a cloud alone")
        if "near_ends" in entry:
            near.add((link, cloud, entry.length("near_ends", or_zero=True)))
        else:
            region = region_of(entry.inside(entry.get("within"), f"within of {entry.where}"))
            scene = allowed_within(scene, link, cloud, region, entry.length("grow", 0.0, or_zero=True))
    return replace(scene, near_ends=frozenset(near))


def _attached(name: str, entry: Entry, obstacles: Collection[str]) -> tuple[HeldObject, list[str]]:
    """Return what is held, and the obstacles that it may touch."""
    link, touches = entry.get("link"), entry.texts("touches", "links and obstacles")
    if not isinstance(link, str):
        raise InvalidValue(f"{entry.where} must have the link that carries it, got link: {link!r}")
    body = obstacle_of(name, entry.without("link", "touches"), (*POSE, "link", "touches")).body
    links = tuple(each for each in touches if each not in obstacles)
    return HeldObject(name, body, link, links), [each for each in touches if each in obstacles]


def _range(value: object, what: str) -> tuple[float, float]:
    lower, upper = numbers(value, 2, what)
    if not lower < upper:
        raise InvalidValue(f"{what} must satisfy lower < upper, got {value!r}")
    return lower, upper
