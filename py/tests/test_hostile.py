"""Files and names that are endless, huge or made to deceive: an exception says so, and nothing is read until memory ends."""

import os
import re
from pathlib import Path

import opm_kinematics as opm
import pytest

PLANO = "plano-spherical-5dof"
UNSEEN = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


@pytest.fixture(scope="module")
def plano():
    return opm.examples.load(PLANO)


def readers(m):
    return {
        "mechanism": (opm.Manipulator.load, ".toml"),
        "linkage": (opm.Linkage.load, ".toml"),
        "motion": (lambda path: opm.trajectory(m, path), ".toml"),
        "poses": (lambda path: opm.trajectory(m, path), ".csv"),
        "tolerances": (lambda path: m.accuracy([m.home], tolerances=path), ".toml"),
    }


@pytest.mark.parametrize("reader", ["mechanism", "linkage", "motion", "poses", "tolerances"])
def test_nothing_endless_is_read(plano, tmp_path, reader):
    read, ending = readers(plano)[reader]
    huge, pipe = tmp_path / f"huge{ending}", tmp_path / f"pipe{ending}"
    with open(huge, "wb") as file:
        file.truncate(1 << 40)  # with holes: it takes no room
    os.mkfifo(pipe)
    for path, problem in {
        "/dev/zero": "a device, expected a .* of at most [0-9]+ MiB",
        "/dev/null": "a device, expected a .* of at most [0-9]+ MiB",
        huge: "more than [0-9]+ MiB, expected a ",
        # Nobody writes to it: to open it would take for ever, and Ctrl-C would not be heard.
        pipe: "a pipe, expected a .* of at most [0-9]+ MiB",
    }.items():
        with pytest.raises(opm.OpmError, match=f"{path}: {problem}"):
            read(path)
    with pytest.raises(IsADirectoryError):
        read(tmp_path if ending == ".toml" else Path("/"))


@pytest.mark.parametrize("letter", ["\u202e", "\u2066", "\u200f", "\ufffe", "\uffff", "\x1b", "\x9b", "\n"])
def test_a_name_has_only_what_can_be_seen(plano, letter):
    # A planar arm with two parallel legs.
    def screw(x, y):
        return [0.0, 0.0, 1.0, y, -x, 0.0]

    legs = {"a": [screw(0, 0), screw(0, 1), screw(1, 1)], "b": [screw(3, 0), screw(3, 1.5), screw(1, 1)]}
    actuated = [[True, True, False], [True, False, False]]
    for named in (
        lambda: opm.Manipulator.from_screws({f"a{letter}": legs["a"], "b": legs["b"]}, actuated=actuated),
        lambda: opm.Manipulator.from_screws(legs, actuated=actuated, name=f"x{letter}y"),
        lambda: opm.Manipulator.parse(plano.text.replace('name = "leg2', f'name = "leg2\\u{ord(letter):04x}')),
    ):
        with pytest.raises(opm.OpmError, match=f"without U\\+{ord(letter):04X}") as caught:
            named()
        assert not UNSEEN.search(str(caught.value).replace("\n", " ") if letter == "\n" else str(caught.value))


def test_exceptions_are_short_and_visible(plano):
    hostile = "\x1b[2J\u202e\x9b"
    for text in (hostile, "n" * 1_000_000):
        for fail in (
            lambda: plano.inverse([0, 0, 0, 0, 0], mode=text),
            lambda: opm.Manipulator.parse("format = 1\n", label=text),
            lambda: opm.Manipulator.parse(f'"{text.encode("ascii", "replace").decode()}x" = 1\n'.replace("\x1b", "?")),
            lambda: opm.examples.load(text),
            lambda: opm.sweep(plano, kind=text),
            lambda: opm.sweep(plano, **{text: (0, 1, 2)}),
            lambda: opm.Manipulator.load(text[:3000]),
        ):
            with pytest.raises((opm.OpmError, OSError, ValueError, KeyError)) as caught:
                fail()
            said = str(caught.value) if not isinstance(caught.value, OSError) else repr(caught.value.strerror)
            assert len(said) < 6000 and not UNSEEN.search(said), said[:300]


def test_the_page_is_saved_as_a_page(plano, tmp_path):
    page = plano.explore()
    for wrong in ("a.toml", "a"):
        with pytest.raises(opm.OpmError, match="expected a name that ends in .html"):
            page.save(tmp_path / wrong)
    folder = tmp_path / "folder.html"
    folder.mkdir()
    with pytest.raises(OSError, match="not a regular file"):
        page.save(folder)
    page.save(tmp_path / "a.html")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.html", "folder.html"]


def test_what_is_recovered_is_a_recording(tmp_path):
    given = tmp_path / "a.mcap"
    given.write_bytes(b"")
    (tmp_path / "b.mcap").symlink_to(given)
    with pytest.raises(opm.OpmError, match="expected a name that ends in .mcap"):
        opm.recover(given, tmp_path / "a.csv")
    with pytest.raises(opm.OpmError, match="the file to recover"):
        opm.recover(given, tmp_path / "b.mcap")
