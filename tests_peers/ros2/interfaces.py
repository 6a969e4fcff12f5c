"""Types of nav2, MoveIt and ros2_control with the fields that they have, made by ROS's own generators.

    python -m tests_peers.ros2.interfaces FOLDER

No index serves these packages as wheels.  Their messages are described here by their fields, ROS's generators write the
C of each, and gcc compiles it: FOLDER/python holds the packages, FOLDER/lib their libraries.
"""

import os
import subprocess
import sys
from pathlib import Path

from tests_peers.ros2.fields import MOVEIT, OTHERS

SUPPORTS = ("rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c")
"""What the middleware needs of a type: how it is written, and a description of its fields."""


def interfaces():
    """Return all kinds by package, each with its fields."""
    packages = {}
    for kind, fields in (MOVEIT | OTHERS).items():
        packages.setdefault(kind.partition("/")[0], {})[kind.partition("/")[2]] = fields
    first = ("object_recognition_msgs", "octomap_msgs")
    return {name: packages[name] for name in (*first, *sorted(packages.keys() - {*first}))}


def build(folder):
    """Make every package below a folder."""
    prefix = Path(sys.prefix)
    os.environ["AMENT_PREFIX_PATH"] = sys.prefix
    for package, kinds in interfaces().items():
        _describe(folder / "share" / package, package, kinds)
        _generate(folder, package, kinds, prefix)
        _compile(folder, package, prefix)


def _describe(share, package, kinds):
    """Write the files of the package's interfaces, and the same as IDL."""
    from rosidl_adapter.action import convert_action_to_idl
    from rosidl_adapter.msg import convert_msg_to_idl
    from rosidl_adapter.srv import convert_srv_to_idl

    convert = {"msg": convert_msg_to_idl, "srv": convert_srv_to_idl, "action": convert_action_to_idl}
    for name, fields in kinds.items():
        part = name.partition("/")[0]
        (share / part).mkdir(parents=True, exist_ok=True)
        (share / f"{name}.{part}").write_text(fields + "\n")
        convert[part](share, package, Path(f"{name}.{part}"), share / part)


def _generate(folder, package, kinds, prefix):
    from rosidl_generator_c.cli import GenerateC
    from rosidl_generator_py.cli import GeneratePython
    from rosidl_generator_type_description.cli import HashTypeDescription
    from rosidl_typesupport_c.cli import GenerateCTypesupport
    from rosidl_typesupport_fastrtps_c.cli import GenerateFastRTPSCTypesupport
    from rosidl_typesupport_introspection_c.cli import GenerateIntrospectionCTypesupport

    share, source = folder / "share" / package, folder / "source" / package / package
    files = [f"{share}:{name}.idl" for name in kinds]
    known = [str(prefix / "share"), str(folder / "share")]
    hashes = HashTypeDescription("hash").generate_type_hashes(package, files, known, share)
    GenerateC("c").generate(package, files, known, source, hashes)
    GenerateFastRTPSCTypesupport("fastrtps").generate(package, files, known, source)
    # Its files have the names of others.
    apart = folder / "introspection" / package / package
    GenerateIntrospectionCTypesupport("introspection").generate(package, files, known, apart)
    GenerateCTypesupport("c", typesupport_implementations=list(SUPPORTS)).generate(package, files, known, source)
    python = folder / "python" / package
    GeneratePython("py", typesupport_implementations=["rosidl_typesupport_c"]).generate(package, files, known, python)
    (python / "__init__.py").touch()


def _compile(folder, package, prefix):
    """Compile all of a package's C and C++ into one library, and what Python loads into another."""
    import sysconfig

    import numpy as np

    source, python, lib = folder / "source" / package, folder / "python" / package, folder / "lib"
    lib.mkdir(exist_ok=True)
    written = [*(folder / "source").iterdir(), *(folder / "introspection").iterdir()]
    others = [prefix / "include", *sorted((prefix / "include").iterdir()), *sorted(written)]
    include = [f"-I{each}" for each in (*others, sysconfig.get_path("include"), np.get_include())]
    libraries = [f"-L{prefix / 'lib'}", f"-L{lib}"]
    libraries += [str(each) for each in (prefix / "lib").glob("lib*rosidl*.so")]
    libraries += ["-lrcutils", "-lfastcdr"]
    libraries += [str(each) for each in lib.glob("lib*__all.so")]
    own = lib / f"lib{package}__all.so"
    common = ["-O0", "-w", "-fPIC", "-shared", "-Wl,--unresolved-symbols=ignore-all"]
    both = [*source.rglob("*"), *(folder / "introspection" / package).rglob("*")]
    parts = [str(each) for each in both if each.suffix in (".c", ".cpp")]
    python_parts = [str(each) for each in python.rglob("*_s.c")]
    objects = _objects([*parts, *python_parts], folder / "objects" / package, include)
    subprocess.run(["g++", *common, f"-Wl,-soname,{own.name}", *objects, "-o", str(own), *libraries], check=True)
    for support in SUPPORTS:
        (lib / f"lib{package}__{support}.so").symlink_to(own.name)
    entry = next(python.glob("_*_s.ep.rosidl_typesupport_c.c"))
    target = python / f"{package}_s__rosidl_typesupport_c.so"
    subprocess.run(["gcc", *common, *include, str(entry), "-o", str(target), str(own)], check=True)


def _objects(parts, folder, include):
    """Compile each source by its language, several at a time; return the objects."""
    folder.mkdir(parents=True, exist_ok=True)
    running, objects = [], []
    for i, part in enumerate(parts):
        compiler = ["gcc", "-std=gnu11"] if part.endswith(".c") else ["g++", "-std=c++17"]
        objects.append(str(folder / f"{i}.o"))
        running.append(subprocess.Popen([*compiler, "-O0", "-w", "-fPIC", "-c", *include, part, "-o", objects[-1]]))
        if len(running) >= (os.cpu_count() or 1):
            assert running.pop(0).wait() == 0
    assert all(each.wait() == 0 for each in running)
    return objects


if __name__ == "__main__":
    build(Path(sys.argv[1]).resolve())
