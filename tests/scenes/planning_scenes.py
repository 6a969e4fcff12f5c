"""MoveIt's planning scenes for tests, as YAML has them."""

import evenroad as er

IDENTITY = {"position": {"x": 0.0, "y": 0.0, "z": 0.0}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}


def at(x, y=0.0, z=0.0):
    return {"position": {"x": x, "y": y, "z": z}, "orientation": IDENTITY["orientation"]}


def box(name, pose=IDENTITY, frame="world", **more):
    return {
        "header": {"frame_id": frame, "stamp": {"sec": 0}},
        "id": name,
        "pose": pose,
        "primitives": [{"type": 1, "dimensions": [0.1, 0.1, 0.1]}],
        "primitive_poses": [IDENTITY],
        **more,
    }


def scene_of(*objects, **more):
    return er.Scene({"world": {"collision_objects": list(objects)}, **more})


def places(scene):
    return {each.name: each.xyz for each in scene.obstacles}
