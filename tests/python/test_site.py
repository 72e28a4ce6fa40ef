"""The documentation site is built from the documents without a warning, and its links lead somewhere. `make docs` builds all
of it; here the notebooks are not run, which another test does, and the crates' reference is left out."""

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]


def test_it_is_built_and_its_links_lead_somewhere(tmp_path):
    site = tmp_path / "site"
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-c", "docs/site", ".", str(site)]
    environment = {name: value for name, value in os.environ.items() if name != "OPM_NOTEBOOKS"}
    built = subprocess.run(command, cwd=REPOSITORY, env=environment, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    checked = subprocess.run([sys.executable, "docs/site/check_links.py", str(site)], cwd=REPOSITORY, capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout
    for page in ["index", "docs/tutorial", "docs/theory", "cli/src/format", "docs/python", "examples/planar_legs", "docs/decisions/README"]:
        assert (site / f"{page}.html").exists(), page
    # The reference of the compiled module has the order of its stub, and the docstrings of the module.
    reference = (site / "docs/python.html").read_text(encoding="utf-8")
    assert 'id="opm_kinematics._native.Manipulator.inverse"' in reference
    assert "Inverse kinematics of one pose or of many" in reference


def test_what_notebooks_import_is_installed_for_the_site():
    text = (REPOSITORY / "docs/site/requirements.txt").read_text(encoding="utf-8")
    # The module with its extras brings these.
    installed = set(re.findall(r"^[\w-]+", text, re.MULTILINE)) | {"opm_kinematics", "matplotlib", "cma"} | sys.stdlib_module_names
    notebooks = sorted((REPOSITORY / "examples").glob("*.ipynb"))
    assert notebooks
    for notebook in notebooks:
        cells = [cell for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
        for node in (node for cell in cells for node in ast.walk(ast.parse("".join(cell["source"])))):
            names = [node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in getattr(node, "names", []) if isinstance(node, ast.Import)]
            assert {name.partition(".")[0] for name in names} <= installed, f"{notebook.name}: {names}"
