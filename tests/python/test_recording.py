"""A recording of known points, checked with public decoders (see `check_recording.py`)."""

import csv
import subprocess
from pathlib import Path

import check_recording
import numpy as np
import pytest

# Centimetres. The number of grid points in the ball is sequence A000605 of the OEIS.
RADIUS, POINTS = 10, 4169


def ball(radius):
    """Rows x, y, z, distance in metres, x slowest and z fastest."""
    numbers = range(-radius, radius + 1)
    for point in ((x, y, z) for x in numbers for y in numbers for z in numbers):
        squared = sum(n**2 for n in point)
        if squared <= radius**2:
            yield *(n / 100 for n in point), squared**0.5 / 100


def write(path, rows):
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([("x", "y", "z", "distance"), *rows])


@pytest.fixture(scope="session")
def record(programs):
    """Records a ball."""
    return lambda path, radius: subprocess.run([programs["ball"], path, str(radius)], check=True)


@pytest.fixture(scope="module")
def recording(record, tmp_path_factory):
    path = tmp_path_factory.mktemp("recording") / "ball.mcap"
    record(path, RADIUS)
    return path


def test_the_points_are_those_of_the_ball(recording, tmp_path):
    expected = list(ball(RADIUS))
    assert len(expected) == POINTS
    write(tmp_path / "expected.csv", expected)
    found = check_recording.check(recording, tmp_path / "expected.csv")
    assert found == (POINTS, 2 * RADIUS + 1)


def test_a_decimated_recording(record, tmp_path):
    radius = 80
    record(tmp_path / "large.mcap", radius)
    points, slices = check_recording.check(tmp_path / "large.mcap")
    squares = np.arange(-radius, radius + 1) ** 2
    count = np.sum(squares[:, None, None] + squares[:, None] + squares <= radius**2)
    assert (points, slices) == (count, 2 * radius + 1)
    assert points > check_recording.MAX_OVERVIEW_POINTS


def test_the_check_finds_a_wrong_point(recording, tmp_path):
    expected = [list(row) for row in ball(RADIUS)]
    expected[1234][2] += 1e-7
    write(tmp_path / "wrong.csv", expected)
    with pytest.raises(check_recording.Failure, match="z of point 1234"):
        check_recording.check(recording, tmp_path / "wrong.csv")
    write(tmp_path / "short.csv", expected[:-1])
    with pytest.raises(check_recording.Failure, match="4169 points, expected 4168"):
        check_recording.check(recording, tmp_path / "short.csv")


def test_a_recording_cut_short_is_recovered(recording, tmp_path):
    """`pymcap-cli recover` makes the first part readable, and it is not marked as complete."""
    with open(recording, "rb") as file:
        chunks = check_recording.make_reader(file).get_summary().chunk_indexes
    # Within a chunk: the tool loses track of one whose index alone is cut.
    chunk = chunks[len(chunks) // 2]
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(recording.read_bytes()[: chunk.chunk_start_offset + chunk.chunk_length // 2])
    with pytest.raises(check_recording.Failure, match="doctor"):
        check_recording.check(cut)
    recovered = tmp_path / "recovered.mcap"
    tool = Path(check_recording.sys.executable).with_name("pymcap-cli")
    result = subprocess.run([tool, "recover", cut, recovered], capture_output=True)
    assert result.returncode == 3, "recovered, and some was lost"
    check_recording.doctor(recovered)
    with open(recovered, "rb") as file:
        reader = check_recording.make_reader(file)
        topics = [channel.topic for _, channel, _ in reader.iter_messages()]
        assert topics.count(check_recording.OVERVIEW) == 1
        assert 0 < topics.count(check_recording.SLICES) < 2 * RADIUS + 1
        assert all("complete" not in record.metadata for record in reader.iter_metadata())
