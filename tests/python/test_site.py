"""The documentation site is built from the documents without a warning, and its links lead somewhere. `make docs` builds all
of it; here the notebooks are not run, which another test does, and the crates' reference is left out."""

import os
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
    for page in ["docs/tutorial", "docs/theory", "cli/src/format", "docs/python", "examples/planar_legs", "docs/decisions/README"]:
        assert (site / f"{page}.html").exists(), page
    # The reference of the compiled module comes from its stub.
    assert 'id="opm_kinematics._native.Manipulator.inverse"' in (site / "docs/python.html").read_text(encoding="utf-8")
