"""Writing a scene: the YAML that :func:`evenroad.load_scene` reads, and texts of the meshes and clouds beside it."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from evenroad._checks import as_file, require_known
from evenroad._files import atomic_write
from evenroad.errors import NotAvailable
from evenroad.geometry.shapes import PRIMITIVES, Capsule, Mesh, PointCloud, Shape, along_z
from evenroad.scenes.scene import Obstacle, Scene

Value = str | float | bool | Sequence["Value"] | dict[str, "Value"]
"""What a scene's file is made of."""


@dataclass
class SceneFiles:
    """The text of a scene's file, and those of the meshes and clouds that it names, name -> text.

    The names begin with `stem`.
    """

    stem: str
    text: str = ""
    files: dict[str, str] = field(default_factory=dict)

    def add(self, suffix: str, lines: Sequence[str]) -> str:
        """Keep the text of one more file, and return its name."""
        name = f"{self.stem}-{len(self.files) + 1}{suffix}"
        self.files[name] = "".join(f"{line}\n" for line in lines)
        return name


def save_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write what :meth:`Scene.save` does."""
    file = as_file("what a scene is saved to", path)
    require_known(f"kind of file for a scene, {os.fspath(path)!r}: suffix", file.suffix.lower(), (".yaml", ".yml"))
    texts = scene_files(scene, file.stem)
    for name, text in {**texts.files, file.name: texts.text}.items():
        with atomic_write(file.parent / name) as stream:
            stream.write(text.encode())


def read_scene(text: str, files: dict[str, str], folder: Path) -> Scene:
    """Return the scene of texts, which are written to a folder."""
    from evenroad.scenes.scene_file import load_scene

    for name, content in {**files, "scene.yaml": text}.items():
        (folder / Path(name).name).write_text(content, encoding="utf-8")
    return load_scene(folder / "scene.yaml")


def scene_files(scene: Scene, stem: str) -> SceneFiles:
    """Return the text of a scene and of the files that it names.

    Raises NotAvailable for a scene of MoveIt whose objects are in the frames of links.
    """
    if scene.setup.frames is not None:
        raise NotAvailable(
            f"scene {scene.name!r} has objects in the frames of links, which are known with a robot:"
            " er.ArmWorld(robot, scene).scene has them in the frame of its root"
        )
    made = SceneFiles(stem)
    allowed: dict[str, list[Value]] = {}
    for link, name in sorted(scene.allowed):
        allowed.setdefault(name, []).append(link)
    for link, name, distance in sorted(scene.near_ends):
        allowed.setdefault(name, []).append({"link": link, "near_ends": distance})
    sections: dict[str, dict[str, Value]] = {
        "obstacles": {each.name: _obstacle(each, made) for each in scene.obstacles},
        "allowed": dict(allowed),
        "states": {name: dict(state) for name, state in scene.states.items()},
        "limits": {joint: list(limits) for joint, limits in scene.limits.items()},
        "attach": {
            each.name: {**_body(each.body, made), "link": each.link, "touches": list(each.touches)}
            for each in scene.attached
        },
    }
    lines = [f"name: {json.dumps(scene.name)}"]
    for section, entries in sections.items():
        if entries or section == "obstacles":
            lines.append(f"{section}:" if entries else f"{section}: {{}}")
            # JSON is YAML, but for the point that YAML 1.1 wants before an exponent.
            lines += [f"  {json.dumps(name)}: {_written(entry)}" for name, entry in entries.items()]
    made.text = "".join(f"{line}\n" for line in lines)
    return made


def _obstacle(obstacle: Obstacle, made: SceneFiles) -> dict[str, Value]:
    said = _body(obstacle.body, made)
    said |= {"cell": True} if obstacle.cell else {}
    said |= {"clearance": obstacle.clearance} if obstacle.clearance else {}
    if obstacle.seen is not None:
        said |= {"seen_at": obstacle.seen.at, "margin": obstacle.seen.margin}
    if obstacle.cuts:
        said["cut"] = [{"attached": cut.attached, "at": cut.at, "grow": cut.grow} for cut in obstacle.cuts]
    return said


def _body(shape: Shape, made: SceneFiles) -> dict[str, Value]:
    body = along_z(shape) if isinstance(shape, Capsule) else shape
    placed: dict[str, Value] = {"xyz": list(body.pose.xyz), "xyzw": list(body.pose.xyzw)}
    if isinstance(body, PointCloud):
        file = made.add(".xyz", [" ".join(map(repr, row)) for row in body.points.tolist()])
        return {"shape": "cloud", "file": file, "radius": body.radius, **placed}
    if isinstance(body, Mesh):
        mesh = body.triangles
        corners = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
        faces = [f"f {a} {b} {c}" for a, b, c in (np.asarray(mesh.triangles) + 1).tolist()]
        return {"shape": "mesh", "file": made.add(".obj", [*corners, *faces]), **placed}
    left = [float(value) for value in body.size]
    rows = {key: [left.pop(0) for _ in range(count)] for key, count in PRIMITIVES[body.kind].dimensions}
    return {"shape": body.kind, **{key: row if len(row) > 1 else row[0] for key, row in rows.items()}, **placed}


def _written(value: Value) -> str:
    """Return a value in one line of YAML."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_key(key)}: {_written(each)}' for key, each in value.items())}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_written, value))}]"
    if isinstance(value, float):
        text = repr(float(value))
        return text.replace("e", ".0e") if "e" in text and "." not in text else text
    return json.dumps(value)


def _key(key: str) -> str:
    return key if key.isidentifier() else json.dumps(key)
