"""What the pages of the documentation tell a reader to do, as it is written there.

A page is walked from top to bottom in a folder of its own: a file that it says to save is saved, its commands are run, and
its Python code too. Every block of code on every page is run here or is named below, with what holds it instead.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
PAGES = [
    *sorted(path.relative_to(REPOSITORY).as_posix() for path in (REPOSITORY / "docs").glob("*.md")),
    *("README.md", "ARCHITECTURE.md", "BENCHMARKS.md", "CONTRIBUTING.md", "cli/README.md", "cli/src/format.md"),
    *("docs/gallery/README.md", "py/README.md"),
]
# A block is fenced, with its language, or indented by four spaces between empty lines.
BLOCK = re.compile(r"(?:Save this as `(?P<name>[^`]+)`[^\n]*(?:\n[^\n`#]+)*?:\n\n)?^```(?P<kind>[^\n]*)\n(?P<text>.*?)^```$", re.M | re.S)
INDENTED = re.compile(r"(?<=\n\n)((?:    (?:\$ )?opm [^\n]*\n(?:    [^\n]*\n)*))", re.M)
# Commands that change the machine, or that build for minutes. `make test` is this test.
NOT_RUN = re.compile(r"pip install|cargo install|make test$|python -m mujoco")
# What a reader brings, by the part of a command that takes it: measurements of a machine without errors are its plan.
BROUGHT = {"--measurements m.csv": "cp plan.csv m.csv"}
# What is no code, by the language of its block.
NO_CODE = {"text", "protobuf", "", "{toctree}", "{eval-rst}", "json"}
# What other tests hold, by page and language.
ELSEWHERE = {
    ("README.md", "python"): "py/tests/test_readme.py",
    ("py/README.md", "python"): "py/tests/test_readme.py",
    ("README.md", "rust"): "tests/src/lib.rs",
    ("docs/rust.md", "rust"): "tests/src/lib.rs",
    ("README.md", "toml"): "an excerpt of a file",
    ("docs/accuracy.md", "toml"): "crates/opm-accuracy/tests",
    ("docs/exporting.md", "toml"): "an excerpt of a file; tests/python/test_schema.py knows its keys",
    ("docs/exporting.md", "yaml"): "tests/python/test_urdf.py",
    ("cli/src/format.md", "toml"): "tests/python/test_schema.py",
    ("cli/src/format.md", "toml (obstacles of plano-spherical-5dof)"): "tests/python/test_schema.py",
    ("cli/src/format.md", "toml (differences of plano-spherical-5dof)"): "tests/python/test_schema.py",
    ("cli/src/format.md", "toml (joints)"): "tests/python/test_schema.py",
    ("docs/scaling.md", "console"): "tests/python/test_shards.py",
    ("docs/scaling.md", "sh"): "tests/python/test_shards.py",
    ("docs/scaling.md", "python"): "tests/python/test_shards.py",
    ("docs/extending.md", "sh"): "make lint and make test",
    ("docs/frameworks.md", "python (jax)"): "py/tests/test_frameworks.py",
    ("docs/frameworks.md", "python (torch)"): "py/tests/test_frameworks.py",
    ("docs/generating.md", "c"): "crates/opm-generate/tests/languages",
    ("docs/generating.md", "rust"): "crates/opm-generate/tests/languages",
    ("docs/generating.md", "matlab"): "crates/opm-generate/tests/languages",
    ("docs/generating.md", "python"): "crates/opm-generate/tests/languages",
}


def blocks(page):
    """The blocks of a page in their order: the language, the name of the file to save, the text."""
    text = (REPOSITORY / page).read_text(encoding="utf-8")
    found = [(m.start(), m["kind"].strip(), m["name"], m["text"]) for m in BLOCK.finditer(text)]
    spans = [m.span() for m in BLOCK.finditer(text)]
    for m in INDENTED.finditer(text):
        if not any(start <= m.start() < end for start, end in spans):
            found.append((m.start(), "indented", None, re.sub(r"^    ", "", m[1], flags=re.M)))
    return [entry[1:] for entry in sorted(found)]


def commands(kind, text):
    """The commands of a block: in a console those behind a `$`, else all; a line that ends in a backslash goes on."""
    lines = text.replace("\\\n", " ").splitlines()
    if any(line.startswith("$ ") for line in lines):
        return [line[2:] for line in lines if line.startswith("$ ")]
    assert kind == "indented", f"a console without a prompt: {text}"
    return [line for line in lines if line]


def elsewhere(page, kind):
    return (page, kind) in ELSEWHERE or (page == "cli/src/format.md" and kind.startswith("toml"))


def work(page):
    return [b for b in blocks(page) if b[1] or (b[0] in ("console", "indented", "python") and not elsewhere(page, b[0]))]


@pytest.mark.parametrize("page", [page for page in PAGES if work(page)])
def test_what_a_page_says_runs(opm, tmp_path, page):
    environment = {**os.environ, "PATH": f"{Path(opm).parent}{os.pathsep}{os.environ['PATH']}", "MPLBACKEND": "Agg"}
    # The mechanism of format.md, which the page shows before its commands, and other blocks without a name.
    if page == "cli/src/format.md":
        example = next(text for kind, _, text in blocks(page) if kind == "toml")
        (tmp_path / "lift.toml").write_text(example, encoding="utf-8")
    for kind, name, text in work(page):
        if name:
            (tmp_path / name).write_text(text, encoding="utf-8")
        elif kind == "python":
            done = subprocess.run([sys.executable, "-c", text], cwd=tmp_path, env=environment, capture_output=True, text=True)
            assert done.returncode == 0, f"{text}\n{done.stderr}"
        else:
            for command in commands(kind, text):
                command = command.replace("cargo run --release --", "opm")
                if NOT_RUN.search(command):
                    continue
                before = "".join(f"{script} && " for part, script in BROUGHT.items() if part in command)
                done = subprocess.run(["sh", "-c", before + command], cwd=tmp_path, env=environment, capture_output=True, text=True)
                assert done.returncode == 0, f"{command}\n{done.stderr}"


@pytest.mark.parametrize("page", PAGES)
def test_every_block_is_run_or_held_elsewhere(page):
    for kind, name, text in blocks(page):
        known = name or kind in NO_CODE or kind in ("console", "indented", "python") or elsewhere(page, kind)
        assert known, f"{page}: nothing runs this block of {kind}:\n{text}"


def test_what_is_said_to_be_elsewhere_is_there():
    for (page, kind), where in ELSEWHERE.items():
        assert any(kind == found for found, *_ in blocks(page)), f"{page} has no block of {kind}"
        if "/" in where.split(";")[0]:
            path = where.split("; ")[-1].split(" knows")[0]
            assert (REPOSITORY / path).exists(), path
