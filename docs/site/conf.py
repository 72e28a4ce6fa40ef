"""The documentation site: `make docs`. Its pages are the documents of the repository, where they lie; the repository is the
source folder, so that their links to each other mean the same on the site as in a checkout."""

import __future__

import importlib
import os
import re
import sys
from pathlib import Path

import latex2mathml.converter
from docutils.nodes import SkipNode

try:
    import tomllib
except ImportError:  # Python 3.10
    import tomli as tomllib

REPOSITORY = Path(__file__).parents[2]
PACKAGE = tomllib.loads((REPOSITORY / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]

project = "opm"
author = PACKAGE["authors"][0]
version = release = PACKAGE["version"]
copyright = author


def _module_from_its_stub(compiled):
    """The members of the compiled module in the order of its stub, with its signatures; the compiled module, which is
    installed, has the docstrings."""
    path = REPOSITORY / "py/python/opm_kinematics/_native.pyi"
    module = type(sys)("opm_kinematics._native")
    flags = __future__.annotations.compiler_flag
    exec(compile(path.read_text(encoding="utf-8"), str(path), "exec", flags=flags), module.__dict__)
    module.__version__ = compiled.__version__
    for name in module.__all__:
        described, real = getattr(module, name), getattr(compiled, name)
        if name == "__version__":
            continue
        described.__doc__ = real.__doc__
        for member, thing in vars(described).items() if isinstance(described, type) else ():
            if not member.startswith("__"):
                getattr(thing, "__func__", thing).__doc__ = getattr(real, member).__doc__
    return module


sys.modules["opm_kinematics._native"] = _module_from_its_stub(importlib.import_module("opm_kinematics._native"))

extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc"]
root_doc = "docs/index"
include_patterns = [
    "docs/*.md",
    "docs/decisions/*.md",
    "docs/gallery/*.md",
    "cli/src/format.md",
    "py/README.md",
    "examples/*.ipynb",
    "ARCHITECTURE.md",
    "BENCHMARKS.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
]

myst_enable_extensions = ["attrs_inline", "deflist", "dollarmath"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
highlight_language = "none"

# Notebooks are stored without outputs. The tests run them anyhow, so that the test of the site does not.
nb_execution_mode = "force" if "OPM_NOTEBOOKS" in os.environ else "off"
nb_execution_timeout = 300
nb_execution_raise_on_error = True

# Formulas are MathML, which browsers draw by themselves: nothing comes from a network.
html_math_renderer = "mathml"
myst_update_mathjax = False
nb_ipywidgets_js = {}

autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_show_class_members = False

html_theme = "furo"
html_title = "opm"
html_copy_source = False
html_show_sphinx = False
# What else `make docs` builds: the reference of the crates, and the pages of the explorer.
html_extra_path = [path] if os.path.isdir(path := str(REPOSITORY / "target/site-extra")) else []

_LINK = re.compile(r"(\]\()([^)#\s]+)((?:#[^)\s]*)?\))")
_HEADING = re.compile(r"^## ([a-z0-9-]+)\n", re.MULTILINE)
_PICTURES = {".png", ".svg"}


def _outside(app, page, text):
    """Links to files that are no pages lead to the repository."""
    folder = (REPOSITORY / page).parent

    def lead(match):
        target = match[2]
        path = (folder / target).resolve()
        if "://" in target or path.suffix in _PICTURES or not path.is_relative_to(REPOSITORY) or not path.exists():
            return match[0]
        name = path.relative_to(REPOSITORY)
        if name.with_suffix("").as_posix() in app.env.found_docs and path.is_file():
            return match[0]
        return f"{match[1]}{PACKAGE['repository']}/{name.as_posix()}{match[3]}"

    return _LINK.sub(lead, text)


def _live(text):
    """Every manipulator of the gallery has a page of the explorer; linkages have none."""

    def add(match):
        name = match[1]
        mechanism = REPOSITORY / f"crates/opm-core/mechanisms/{name}.toml"
        if not mechanism.exists() or not (REPOSITORY / f"target/site-extra/explorer/{name}.html").exists():
            return match[0]
        return f'{match[0]}\n<p><a href="../../explorer/{name}.html">Move it in your browser</a></p>\n'

    return _HEADING.sub(add, text)


def _others(text):
    """Pages that the table of contents does not name yet stand in it behind the last of design and use."""
    listed = set(re.findall(r"^[\w-]+$", text, re.MULTILINE)) | {"index"}
    others = sorted(path.stem for path in (REPOSITORY / "docs").glob("*.md") if path.stem not in listed)
    return text.replace("\ngenerating\n", "\n".join(["", "generating", *others, ""]), 1)


def _one_title(text):
    """A page with several titles, as a long document may have, has one on the site, with the others below it."""
    lines, fenced, titles = text.split("\n"), False, 0
    for number, line in enumerate(lines):
        fenced ^= line.startswith("```")
        if not fenced and re.match(r"#+ ", line):
            titles += line.startswith("# ")
            lines[number] = f"#{line}" if titles > 1 else line
    return "\n".join(lines)


def _read(app, page, source):
    if page.startswith("examples/"):
        return
    source[0] = _one_title(_outside(app, page, source[0]))
    if page == "docs/index":
        source[0] = _others(source[0])
    if page == "docs/gallery/README":
        source[0] = _live(source[0])
    if page == "docs/decisions/README":
        source[0] += "\n```{toctree}\n:hidden:\n:glob:\n\n0*\n```\n"


def _inline_formula(translator, node):
    translator.body.append(latex2mathml.converter.convert(node.astext()))
    raise SkipNode


def _formula(translator, node):
    translator.body.append(latex2mathml.converter.convert(node.astext(), display="block"))
    raise SkipNode


def _front_door(app, error):
    """Who opens the folder of the site comes to its first page."""
    if error is None and app.builder.name == "html":
        door = f'<!DOCTYPE html><meta charset="utf-8"><title>opm</title><meta http-equiv="refresh" content="0; url={root_doc}.html">'
        (Path(app.outdir) / "index.html").write_text(f'{door}<a href="{root_doc}.html">opm</a>\n', encoding="utf-8")


def setup(app):
    app.add_html_math_renderer("mathml", (_inline_formula, None), (_formula, None))
    app.connect("source-read", _read)
    app.connect("build-finished", _front_door)
