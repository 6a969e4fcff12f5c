"""How Sphinx builds the pages: ``make docs``.  It needs no network, and the pages need none."""

import contextlib
import inspect
import pydoc
import re
import sys
from pathlib import Path

from docutils import nodes
from sphinx import addnodes
from sphinx.ext.napoleon import NumpyDocstring

sys.path.insert(0, str(Path(__file__).parents[1] / "tools"))
import docs_pages

import evenroad

project, author, release = "evenroad", "The evenroad authors", evenroad.__version__
project_copyright = author
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["data", "notebooks"]
nitpicky = True
# Types of others, and texts of ours that stand where a type does: there is no page to lead to.
nitpick_ignore_regex = [("py:(class|obj)", r"(?!evenroad\.).*"), ("py:class", r"evenroad\._.*")]

html_theme = "furo"
html_title = f"evenroad {release}"
html_logo = "static/logo.svg"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = html_show_sourcelink = html_show_copyright = False
templates_path: list[str] = []
highlight_language = "text"

myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
suppress_warnings = ["myst.header"]

default_role = "literal"
smartquotes = False
autodoc_mock_imports = docs_pages.NOT_NEEDED
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
toc_object_entries_show_parents = "hide"
python_maximum_signature_line_length = 88
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

_OURS = re.compile(r"(?:er|evenroad)\.([A-Za-z_][\w.]*)(?:\(.*\))?")


def _names(env):
    return env.domains.python_domain.objects


def _find(env, target):
    """Return the documented name of an object that is spoken of by another: its home, or its last word alone."""
    names = {name: entry for name, entry in _names(env).items() if not entry.aliased}
    known = docs_pages.documented_name(target)
    if known in names:
        return known
    found = [name for name in names if name.endswith(f".{target}")] or [
        # The fields of a class stand in its list.
        name
        for name in names
        if name.endswith(f".{target.rpartition('.')[0]}") and "." in target
    ]
    return found[0] if len(found) == 1 else None


def _link(app, document, name, content):
    entry = _names(app.env)[name]
    where = app.builder.get_relative_uri(document, entry.docname) + f"#{entry.node_id}"
    return nodes.reference("", "", content, internal=True, refuri=where, reftitle=name)


def _resolve(app, env, node, content):
    """Lead a reference to where its object is documented; one to what is not public stays a text."""
    target = node.get("reftarget", "")
    if node.get("refdomain") != "py" or not (name := _find(env, target)):
        around = ".".join(filter(None, (node.get("py:module"), node.get("py:class"))))
        return content if docs_pages.is_internal(target, around) else None
    return _link(app, node["refdoc"], name, content)


def _source_of(node):
    """Return the module whose source says what a name in a signature or its description means."""
    while node is not None and not isinstance(node, addnodes.desc):
        node = node.parent
    if node is None or not node[0].get("module"):
        return None
    thing = pydoc.locate(f"{node[0]['module']}.{node[0]['fullname']}")
    return sys.modules.get(getattr(thing, "__module__", None))


def _leave_words(app, doctree):
    """Leave the words of ``array_like, shape (n, dim)`` what they are: only names with a capital are looked up."""
    for node in list(doctree.findall(addnodes.pending_xref)):
        target = node.get("reftarget", "")
        word = target.rpartition(".")[2]
        if isinstance(meant := getattr(_source_of(node), target, None), type):
            node["reftarget"] = docs_pages.documented_name(f"{meant.__module__}.{meant.__qualname__}")
            node["refspecific"] = False
        if node.get("refdomain") == "py" and node.get("reftype") == "class" and not word[:1].isupper():
            node.replace_self(node.children)


def _call_fields_attributes(app, doctree):
    """Say what everyone says: Sphinx calls them variables."""
    for name in doctree.findall(nodes.field_name):
        if name.astext() == "Variables":
            name.children = [nodes.Text("Attributes")]


def _link_names(app, doctree, document):
    """Turn ``er.plan(...)`` in the text of a page into a link to what is documented of it."""
    for literal in list(doctree.findall(nodes.literal)):
        inside = isinstance(literal.parent, nodes.reference | nodes.title | addnodes.pending_xref)
        if not inside and (match := _OURS.fullmatch(literal.astext())):
            name = f"evenroad.{match[1]}"
            if name in _names(app.env):
                literal.replace_self(_link(app, document, name, literal.deepcopy()))


def _lead_to_pages(app, document, source):
    """Let links to an example or a study lead to its page; folders of files, which are no pages, are only named.

    A page of its own in docs/ that the first page does not list yet comes beside the examples.
    """
    if document == "index":
        new = [path.stem for path in sorted(Path(app.srcdir).glob("*.md"))]
        new = [name for name in new if name != document and not re.search(rf"^(?:.* <)?{name}>?$", source[0], re.M)]
        source[0] = source[0].replace("\nexamples\n", "\n" + "\n".join([*new, "examples"]) + "\n")
    source[0] = re.sub(r"\]\((?:\.\./)+studies/docs/", r"](/generated/studies/", source[0])
    source[0] = re.sub(r"\]\((?:\.\./)+docs/", r"](/", source[0])
    source[0] = re.sub(r"\[([^\]]+)\]\((?:\.\./)+examples/?\w*\)", r"`\1`", source[0])
    source[0] = re.sub(r"\]\((?:\.\./)+examples/(\w+)\.py\)", r"](/generated/examples/\1.md)", source[0])


def _as_written(app, what, name, thing, options, signature, returned):
    """Show the types of a signature as its source has them, not what they stand for."""
    if what not in ("function", "method", "class", "exception"):
        return None
    if getattr(thing, "_is_protocol", False):
        return "", None
    with contextlib.suppress(TypeError, ValueError):
        written = inspect.signature(thing)
        kept = [_shown(each) for each in written.parameters.values() if each.name not in ("self", "cls")]
        arguments = str(inspect.Signature(kept))
        answer = written.return_annotation
        return arguments, answer if isinstance(answer, str) and what in ("function", "method") else None
    return None


class _Text(str):
    """A text that is shown without its quotation marks."""

    __repr__ = str.__str__


def _shown(parameter):
    kind = parameter.annotation
    if isinstance(kind, str):
        parameter = parameter.replace(annotation=_Text(kind.replace("npt.ArrayLike", "array_like")))
    if repr(parameter.default).startswith("<"):
        shown = parameter.empty if parameter.default is parameter.empty else _Text("...")
        parameter = parameter.replace(default=shown)
    return parameter


def _end_sections(app, what, name, thing, options, lines):
    """Tell prose below a list of parameters from a parameter, which is a name with a text below it."""
    within, out = False, []
    for before, line, after in zip(["", *lines], lines, [*lines[1:], ""], strict=False):
        within |= bool(re.fullmatch(r"-{3,}", line))
        if within and line and not before and not line.startswith(" ") and not after.startswith(("-", " ")):
            out.append("")
            within = False
        out.append(line)
    lines[:] = _SEVERAL.sub(_one_by_one, "\n".join([*out, ""])).split("\n")


_SEVERAL = re.compile(r"^((?:\w+, )+\w+)( : .*\n(?:[ ].*\n)+)", re.MULTILINE)


def _one_by_one(match):
    """Give each of several attributes that are described in one line an entry of its own."""
    return "".join(name + match[2] for name in match[1].split(", "))


# "The radius: of ..." says no type before its colon, whatever Napoleon thinks of the texts of properties.
NumpyDocstring._parse_attribute_docstring = lambda self: []


def setup(app):
    """Write the pages that are made from the sources, before Sphinx looks for pages."""
    docs_pages.write_pages(Path(__file__).parent / "generated")
    app.connect("autodoc-process-signature", _as_written)
    app.connect("autodoc-process-docstring", _end_sections, priority=100)
    app.connect("source-read", _lead_to_pages)
    app.connect("doctree-read", _leave_words)
    app.connect("doctree-read", _call_fields_attributes)
    app.connect("missing-reference", _resolve)
    app.connect("doctree-resolved", _link_names)
