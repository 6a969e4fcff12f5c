"""Writing a xacro for a test, and what becomes of it."""

from evenroad.loading.xacro.expand import expanded


def no_package(name):
    raise LookupError(name)


def xacro(tmp_path, content, name="a.xacro"):
    """Write a xacro with this content; return its path."""
    path = tmp_path / name
    path.write_text(f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{content}</robot>')
    return path


def read(path, find=no_package, packages=None, **arguments):
    """Return the outermost element of what a xacro stands for."""
    return expanded(path, arguments, find, packages or {})
