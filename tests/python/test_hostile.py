"""Inputs that are endless, huge or made to deceive, and outputs that are closed or are an input: `opm` says so, and ends."""

import os
import pty
import re
import resource
import signal
import subprocess
import time
from pathlib import Path

import pytest
from mcap.writer import Writer

PLANO = "plano-spherical-5dof"
MECHANISM = (Path(__file__).parents[2] / f"crates/opm-core/mechanisms/{PLANO}.toml").read_text()
#: Memory, bytes: more than any of these commands needs.
MEMORY = 3 << 30
SECONDS = 60
#: What clears a screen, sets a title and turns the direction of writing; the last line looks like a message of its own.
HOSTILE = "\x1b[2J\x1b]0;title\x07\u202e\x9b31m\nopm: error: forged"


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def run(opm, *line, **options):
    options = {"capture_output": True, "timeout": SECONDS, "preexec_fn": limited} | options
    done = subprocess.run([opm, *line], **options)
    assert done.stderr is None or b"panicked" not in done.stderr
    return done


def refused(opm, *line, status=1, **options):
    done = run(opm, *line, **options)
    said = done.stderr.decode()
    assert done.returncode == status, said
    return said


#: Every command with a file that it reads.
READERS = {
    "mechanism": ["decompose", "{}"],
    "design": ["design", "{}"],
    "motion": ["trajectory", PLANO, "--motion", "{}"],
    "export": ["export", "mjcf", PLANO, "--trajectory", "{}", "-o", "model.xml"],
    "poses": ["ik", PLANO, "--poses", "{}"],
    "joints": ["fk", PLANO, "--poses", "{}"],
    "analysis": ["analyze", PLANO, "--poses", "{}"],
    "measurements": ["calibrate", PLANO, "--measurements", "{}"],
    "plan": ["calibrate", PLANO, "--plan", "3", "--poses", "{}"],
    "tolerances": ["accuracy", PLANO, "--tolerances", "{}"],
    "inspect": ["inspect", "{}"],
    "recover": ["recover", "{}", "-o", "recovered.mcap"],
    "layout": ["layout", "{}"],
    "plot": ["plot", "{}", "-o", "plot.svg"],
    "merge": ["merge", "{}"],
}


@pytest.mark.parametrize("reader", READERS)
def test_nothing_endless_is_read(opm, tmp_path, reader):
    huge = tmp_path / ("huge.csv" if reader in ("motion", "export") else "huge.toml")
    with open(huge, "wb") as file:
        file.truncate(1 << 40)  # with holes: it takes no room
    for name in ("/dev/zero", "/dev/null", "/dev/full", str(tmp_path), str(huge)):
        said = refused(opm, *[part.format(name) for part in READERS[reader]], cwd=tmp_path)
        assert said.count("\n") == 1 and name in said and len(said) < 500
    assert list(tmp_path.iterdir()) == [huge]


@pytest.mark.parametrize("reader", ["mechanism", "design", "motion", "tolerances", "measurements", "poses"])
def test_an_endless_pipe_ends_at_a_limit(opm, tmp_path, reader):
    """Pipes are read, as a shell's `<(...)` makes them, but not until the memory ends."""
    endless = subprocess.Popen(["yes", "1" * 9], stdout=subprocess.PIPE)
    try:
        name = f"/dev/fd/{endless.stdout.fileno()}"
        line = [part.format(name) for part in READERS[reader]]
        said = refused(opm, *line, pass_fds=[endless.stdout.fileno()], cwd=tmp_path)
        assert name in said and (" MiB, expected " in said or reader in ("poses", "measurements")), said
    finally:
        endless.kill()
        endless.communicate()


PRINTERS = [
    "--help",
    "--version",
    "help ik",
    "examples",
    "schema",
    "format",
    "licenses",
    "completions bash",
    "completions man",
    f"decompose {PLANO}",
    f"ik {PLANO} --pose x=10mm --format json",
    f"ik {PLANO} --poses poses.csv",
    f"velocity {PLANO}",
    f"convert {PLANO}",
    f"explore {PLANO}",
    f"export mjcf {PLANO}",
    f"plot {PLANO} -o -",
    f"workspace {PLANO} --grid x=0:0.1:5",
    f"trajectory {PLANO} --motion plano-spherical-sinusoids -o -",
    "linkage sarrus --sweep",
]


@pytest.mark.parametrize("line", PRINTERS)
def test_a_result_that_nobody_can_get_is_a_failure(opm, tmp_path, line):
    (tmp_path / "poses.csv").write_text("x\n0.01\n")
    closed = ["sh", "-c", 'exec "$0" "$@" >&-', opm, *line.split()]
    done = subprocess.run(closed, stderr=subprocess.PIPE, cwd=tmp_path, timeout=SECONDS, text=True)
    assert done.returncode == 1 and "standard output: it is closed" in done.stderr, done.stderr
    with open("/dev/full", "wb") as full:
        said = refused(opm, *line.split(), capture_output=False, stdout=full, stderr=subprocess.PIPE, cwd=tmp_path)
    assert "standard output: No space left" in said
    # Nobody wants it: that is no failure.
    assert run(opm, *line.split(), capture_output=False, stdout=subprocess.DEVNULL, cwd=tmp_path).returncode == 0


def test_what_goes_to_a_file_needs_no_standard_output(opm, tmp_path):
    closed = ["sh", "-c", 'exec "$0" "$@" >&-', opm, "convert", PLANO, "-o", tmp_path / "a.toml"]
    assert subprocess.run(closed, timeout=SECONDS).returncode == 0
    assert (tmp_path / "a.toml").read_text() == MECHANISM


def test_an_output_is_no_input_by_another_name(opm, tmp_path):
    recording, mechanism, poses = tmp_path / "a.mcap", tmp_path / "a.toml", tmp_path / "a.csv"
    grid = ["--grid=x=-0.1:0.1:5", "--grid=y=-0.1:0.1:5", "--quiet"]
    assert run(opm, "workspace", PLANO, *grid, "-o", recording).returncode == 0
    mechanism.write_text(MECHANISM)
    poses.write_text("x\n0.01\n")
    writers = {
        ("layout", recording): ["json", "py"],
        ("plot", recording): ["svg", "png", "pdf"],
        ("recover", recording): ["mcap"],
        ("convert", mechanism): ["toml"],
        ("explore", mechanism): ["html"],
        ("export mjcf", mechanism): ["xml"],
        ("export urdf", mechanism): ["urdf"],
        (f"ik {PLANO} --poses", poses): ["csv"],
    }
    for (command, given), endings in writers.items():
        before = given.read_bytes()
        for ending in endings:
            soft, hard = tmp_path / f"soft.{ending}", tmp_path / f"hard.{ending}"
            soft.symlink_to(given.name)
            hard.hardlink_to(given)
            (tmp_path / "folder").mkdir()
            for name in (soft, hard, tmp_path / "folder" / ".." / soft.name):
                said = refused(opm, *command.split(), given, "-o", name, status=2)
                assert "is also the input" in said or "is the file to recover" in said
            soft.unlink()
            hard.unlink()
            (tmp_path / "folder").rmdir()
            # As the output is called until it is whole.
            partial = tmp_path / f"unfinished.{ending}.partial"
            partial.write_bytes(before)
            said = refused(opm, *command.split(), partial, "-o", partial.with_suffix(""), status=2)
            assert "is also the input" in said
            assert partial.read_bytes() == before
            partial.unlink()
        assert given.read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.mcap", "a.toml"]


ENDINGS = {
    f"ik {PLANO} --poses poses.csv": ".csv",
    f"fk {PLANO} --poses poses.csv": ".csv",
    f"analyze {PLANO} --poses poses.csv": ".csv",
    f"accuracy {PLANO} --axes 1um,1urad --poses poses.csv": ".csv",
    f"accuracy {PLANO} --axes 1um,1urad --grid x=0:0.01:3": ".csv",
    f"calibrate {PLANO} --plan 3": ".csv",
    f"path {PLANO} --from x=0 --to x=0.01": ".csv",
    f"convert {PLANO}": ".toml",
    f"explore {PLANO}": ".html",
    f"export mjcf {PLANO}": ".xml",
    f"export urdf {PLANO}": ".urdf",
    f"plot {PLANO}": ".svg",
    f"workspace {PLANO} --grid x=0:0.01:3": ".mcap",
    f"trajectory {PLANO} --motion plano-spherical-sinusoids": ".mcap",
    "linkage sarrus --sweep": ".csv",
}


@pytest.mark.parametrize("line", ENDINGS)
def test_a_file_is_what_its_name_says(opm, tmp_path, line):
    (tmp_path / "poses.csv").write_text("x\n0.01\n")
    for wrong in ("out.txt", "out.docx", "out"):
        said = refused(opm, *line.split(), "-o", wrong, status=2, cwd=tmp_path)
        assert f"{wrong}" in said and "expected a name that ends in " in said and ENDINGS[line] in said, said
    assert [path.name for path in tmp_path.iterdir()] == ["poses.csv"]


def on_a_terminal(opm, *line, cwd):
    """What a terminal is told, without the progress bar."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen([opm, *line, "--quiet"], stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs, cwd=cwd)
    os.close(theirs)
    told = b""
    try:
        while more := os.read(ours, 1 << 16):
            told += more
    except OSError:  # the terminal closed with the process
        pass
    os.close(ours)
    process.wait(SECONDS)
    return told.decode().replace("\r\n", "\n")


def hostile_files(folder):
    with open(folder / "topics.mcap", "wb") as file:
        writer = Writer(file)
        writer.start(profile=HOSTILE, library=HOSTILE)
        schema = writer.register_schema(HOSTILE, "jsonschema", b"{}")
        writer.add_message(writer.register_channel(HOSTILE, "json", schema), 1, b"{}", 1)
        writer.add_metadata(HOSTILE, {HOSTILE: HOSTILE})
        writer.add_metadata("run", {"kind": HOSTILE, "mode": HOSTILE, "mechanism": HOSTILE, "grid.x": HOSTILE})
        writer.add_attachment(1, 1, HOSTILE, HOSTILE, HOSTILE.encode())
        writer.finish()
    with open(folder / "cloud.mcap", "wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("foxglove.PointCloud", "protobuf", b"")
        writer.add_message(writer.register_channel(HOSTILE, "protobuf", schema), 1, b"\xff\xff\xff", 1)
        writer.finish()
    text = HOSTILE.replace("\x1b", "\\u001b").replace("\x07", "\\u0007").replace("\x9b", "\\u009b").replace("\n", "\\n")
    (folder / "comment.toml").write_text(MECHANISM + "# \u202e \x9b31m\n")
    (folder / "name.toml").write_text(MECHANISM.replace('name = "', f'name = "{text}', 1))
    (folder / "key.toml").write_text(f'"{text}" = 1\n' + MECHANISM)
    (folder / "syntax.toml").write_text(f"format = 1\nname = \x1b[2J{HOSTILE}")
    (folder / "design.toml").write_text(f'format = 1\nname = "a"\nmechanism = "{text}"\n')
    (folder / "tolerances.toml").write_text(f'[joint]\n"{text}" = 1\n')
    (folder / "header.csv").write_text("t,x\x1b[2J\u202e\n0,1\n")
    (folder / "cell.csv").write_text("t,x\n0,1\x1b[2J\u202e\n")
    motion = 'format = 1\nname = "a"\nunits = { length = "mm", angle = "deg" }\nrate = 1\nduration = 1\n'
    (folder / "mode.toml").write_text(motion + f'mode = "{text}"\n[coordinates]\n"{text}" = 1\n')


DECEIVED = [
    ["inspect", "topics.mcap"],
    ["inspect", "topics.mcap", "--format", "json"],
    ["inspect", "cloud.mcap"],
    ["recover", "cloud.mcap", "-o", "r.mcap"],
    ["layout", "topics.mcap"],
    ["layout", "cloud.mcap"],
    ["plot", "topics.mcap", "-o", "p.svg"],
    ["plot", "cloud.mcap", "-o", "p.svg"],
    ["merge", "topics.mcap"],
    ["decompose", "name.toml"],
    ["decompose", "key.toml"],
    ["decompose", "syntax.toml"],
    ["convert", "comment.toml"],
    ["design", "design.toml"],
    ["accuracy", PLANO, "--tolerances", "tolerances.toml"],
    ["ik", PLANO, "--poses", "header.csv"],
    ["ik", PLANO, "--poses", "cell.csv"],
    ["trajectory", PLANO, "--motion", "header.csv"],
    ["trajectory", PLANO, "--motion", "cell.csv"],
    ["trajectory", PLANO, "--motion", "mode.toml"],
    ["calibrate", PLANO, "--measurements", "header.csv"],
    ["ik", PLANO, "--pose", "x=0", "--mode", HOSTILE],
    ["ik", PLANO, "--pose", HOSTILE],
    ["workspace", PLANO, "--kind", HOSTILE],
    ["decompose", HOSTILE],
    ["decompose", PLANO, "--set", f"{HOSTILE}=1"],
    ["plot", PLANO, "-o", HOSTILE],
    ["convert", PLANO, "-o", f"{HOSTILE}/a.toml"],
    ["schema", HOSTILE],
    [HOSTILE],
]


@pytest.mark.parametrize("line", DECEIVED, ids=lambda line: re.sub(r"[^ -~]+", "?", " ".join(line)))
def test_a_terminal_is_told_nothing_that_it_would_obey(opm, tmp_path, line):
    hostile_files(tmp_path)
    told = on_a_terminal(opm, *line, cwd=tmp_path)
    # The styles of messages of usage are the program's own.
    told = re.sub(r"\x1b\[[0-9;]*m", "", told) if "--help" in told else told
    assert told and re.findall(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e]", told) == []
    assert "\nopm: error: forged" not in told


def test_a_pipe_gets_every_byte(opm, tmp_path):
    hostile_files(tmp_path)
    done = run(opm, "convert", "comment.toml", cwd=tmp_path)
    assert done.stdout == (tmp_path / "comment.toml").read_bytes()


@pytest.mark.parametrize("letter", ["\u202e", "\u2066", "\u200f", "\u061c", "\ufffe", "\uffff", "\ufdd0", "\x7f", "\x85"])
def test_a_name_has_only_what_can_be_seen(opm, tmp_path, letter):
    escaped = f"\\u{ord(letter):04x}"
    places = {
        'name = "plano-spherical-5dof': ("mechanism", MECHANISM),
        'name = "leg2': ("leg", MECHANISM),
    }
    for place, (what, text) in places.items():
        assert place in text, what
        path = tmp_path / "named.toml"
        path.write_text(text.replace(place, place + escaped, 1))
        line = next(number for number, line in enumerate(path.read_text().splitlines(), 1) if escaped in line)
        said = refused(opm, "decompose", path)
        assert f"named.toml:{line}:8: `name` is " in said and f"without U+{ord(letter):04X}" in said, said


def test_long_names_and_cells_take_no_time_and_are_not_repeated(opm, tmp_path):
    long = "n" * 300_000
    named = tmp_path / "named.toml"
    named.write_text(re.sub(r'^name = "(?!plano)', rf'name = "{long}', MECHANISM, flags=re.MULTILINE))
    start = time.monotonic()
    for name in ("a.svg", "a.png", "a.pdf"):
        assert run(opm, "plot", named, "-o", tmp_path / name).returncode == 0
        assert (tmp_path / name).stat().st_size < 1_500_000
    titled = tmp_path / "titled.toml"
    titled.write_text(MECHANISM.replace(f'name = "{PLANO}', f'name = "{long}'))
    for line in (["plot", titled, "-o", tmp_path / "b.svg"], ["generate", "c", titled, "-o", tmp_path / "c"]):
        done = run(opm, *line)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "b.svg").stat().st_size < 1_500_000
    assert time.monotonic() - start < SECONDS
    (tmp_path / "cell.csv").write_text(f"t,x\n0,{'9' * 60_000}z\n1,0\n")
    (tmp_path / "key.toml").write_text(f"{long} = 1\n" + MECHANISM)
    (tmp_path / "cells.csv").write_text(f"x\n{'9' * 60_000}z\n")
    for line in (
        ["trajectory", PLANO, "--motion", "cell.csv"],
        ["decompose", "key.toml"],
        ["ik", PLANO, "--poses", "cells.csv"],
        ["calibrate", PLANO, "--measurements", "cells.csv"],
    ):
        said = refused(opm, *line, cwd=tmp_path)
        assert "more characters)" in said and len(said) < 2000, said[:500]
    for line in (["ik", PLANO, "--pose", f"x={long[:100_000]}"], ["ik", PLANO, "--pose", "x=0", "--mode", long[:100_000]]):
        assert len(refused(opm, *line, status=2)) < 2000


def test_where_no_run_succeeds_the_work_failed(opm):
    line = ["decompose", PLANO, "--vary"]
    done = run(opm, *line, "leg1.alpha1=400deg:500deg:3")
    assert done.returncode == 1 and b"all 3 runs failed" in done.stderr and b"alpha1" in done.stdout
    assert run(opm, *line, "leg1.alpha1=400deg:400deg:1").returncode in (1, 2)
    some = run(opm, *line, "leg1.alpha1=70deg:500deg:2")
    assert some.returncode == 0, some.stderr


def test_a_design_of_too_many_poses_is_refused_at_once(opm, tmp_path):
    problem = tmp_path / "problem.toml"
    problem.write_text(
        f"""format = 1
mechanism = "{PLANO}"
units = {{ length = "mm", angle = "deg" }}
budget = 10
[[objective]]
measure = "reachable"
[grid]
x = [-100, 100, 100000]
y = [-100, 100, 100000]
xi = [-10, 10, 100000]
[variables]
"leg1.h" = [100, 150]
"""
    )
    said = refused(opm, "design", problem)
    assert "1000000000000000 poses, expected at most 10000000" in said, said


JOBS = {
    "explore": ["explore", PLANO, "-o", "out.html"],
    "ik": ["ik", PLANO, "--poses", "poses.csv", "-o", "out.csv"],
    "analyze": ["analyze", PLANO, "--poses", "poses.csv", "-o", "out.csv"],
    "workspace": ["workspace", PLANO, "--grid=x=-0.2:0.2:9001", "--grid=y=-0.2:0.2:9001", "-o", "out.mcap"],
    "trajectory": ["trajectory", PLANO, "--motion", "plano-spherical-sinusoids", "--rate", "1e6", "-o", "out.mcap"],
    "table": ["trajectory", PLANO, "--motion", "plano-spherical-sinusoids", "--rate", "1e6", "-o", "out.csv"],
    "linkage": ["linkage", "sarrus", "--sweep", "--count", "10000000", "-o", "out.mcap"],
    "accuracy": ["accuracy", PLANO, "--axes", "1um,1urad", "--grid=x=-0.1:0.1:999", "--grid=y=-0.1:0.1:999", "-o", "out.csv"],
    "plan": ["calibrate", PLANO, "--plan", "50", "-o", "out.csv"],
    "standard input": ["ik", PLANO, "--poses", "-", "-o", "out.csv"],
}


@pytest.mark.parametrize("job", JOBS)
def test_ctrl_c_leaves_nothing_that_is_not_named(opm, tmp_path, job):
    (tmp_path / "poses.csv").write_text("x,y\n" + "0.001,0.002\n" * 2_000_000)
    for seconds in (0.02, 0.1, 0.5):
        process = subprocess.Popen([opm, *JOBS[job]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=tmp_path)
        time.sleep(seconds)
        process.send_signal(signal.SIGINT)
        # Standard input stays open: it must not be waited for.
        status = process.wait(SECONDS)
        said = process.stderr.read().decode()
        process.stdin.close()
        process.stdout.close()
        process.stderr.close()
        # Done already, ended in order, or ended by the signal before there was a file.
        assert status in (0, 130, -signal.SIGINT), said
        left = [path for path in tmp_path.iterdir() if path.suffix == ".partial"]
        assert all(path.name in said for path in left), (said, left)
        for path in left:
            path.unlink()
