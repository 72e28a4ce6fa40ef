"""Recordings that another program wrote, with the public writer of MCAP: what is whole is called whole."""

import itertools
import json
import shutil
import subprocess
from pathlib import Path

import pytest
from mcap.writer import CompressionType, IndexType, Writer

DATA = Path(__file__).parents[2] / "data" / "reference" / "foreign-recording"
MESSAGES = 5000


def write(path, compression, chunked, summary, checksums):
    # Without chunks there is nothing to compress.
    options = {"compression": compression, "use_chunking": chunked, "enable_crcs": checksums, "enable_data_crcs": checksums}
    if not summary:
        options |= {"index_types": IndexType.NONE, "repeat_channels": False, "repeat_schemas": False}
        options |= {"use_statistics": False, "use_summary_offsets": False}
    with open(path, "wb") as file:
        writer = Writer(file, chunk_size=20_000, **options)
        writer.start(profile="ros2", library="another program")
        schema = writer.register_schema("x.Y", "jsonschema", b"{}")
        channel = writer.register_channel("/t", "json", schema)
        for number in range(MESSAGES):
            writer.add_message(channel, number, b'{"a": %d}' % number, number)
        writer.add_attachment(1, 1, "a.txt", "text/plain", b"hello")
        writer.add_metadata("session", {"by": "somebody"})
        writer.finish()


def inspect(opm, path):
    done = subprocess.run([opm, "inspect", path, "--format", "json"], capture_output=True, text=True)
    return done.returncode, json.loads(done.stdout) if done.stdout else None, done.stderr


KINDS = list(itertools.product(CompressionType, (True, False), (True, False), (True, False)))


@pytest.mark.parametrize(("compression", "chunked", "summary", "checksums"), KINDS)
def test_a_whole_recording_is_whole(opm, tmp_path, compression, chunked, summary, checksums):
    path = tmp_path / "whole.mcap"
    write(path, compression, chunked, summary, checksums)
    status, found, said = inspect(opm, path)
    assert (status, said, found["complete"]) == (0, "", True)
    assert [(topic["name"], topic["messages"]) for topic in found["topics"]] == [("/t", MESSAGES)]
    assert [attached["name"] for attached in found["attachments"]] == ["a.txt"]
    refused = subprocess.run([opm, "recover", path, "-o", tmp_path / "r.mcap"], capture_output=True, text=True)
    assert refused.returncode == 1 and "the recording is whole" in refused.stderr
    assert not (tmp_path / "r.mcap").exists()

    # Cut anywhere, it is not, and what is there is recovered.
    data = path.read_bytes()
    for share in (0.5, 0.99):
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(data[: int(share * len(data))])
        status, found, said = inspect(opm, cut)
        assert status == 0 and not found["complete"] and "cut short" in said
        messages = sum(topic["messages"] for topic in found["topics"])
        assert 0 < messages <= MESSAGES
        again = tmp_path / "again.mcap"
        subprocess.run([opm, "recover", cut, "-o", again], check=True, capture_output=True)
        status, found, said = inspect(opm, again)
        assert sum(topic["messages"] for topic in found["topics"]) == messages and not found["complete"]


def test_a_recording_of_a_robot_is_whole(opm, tmp_path):
    path = shutil.copy(DATA / "points.mcap", tmp_path)
    status, found, said = inspect(opm, path)
    assert (status, said, found["complete"]) == (0, "", True)
    assert [(topic["name"], topic["messages"]) for topic in found["topics"]] == [("/points", 5)]


def test_our_recording_that_another_program_repaired_is_not_called_whole(opm, tmp_path):
    """The end that a repair writes says nothing of the run: its own record of the end is missing."""
    ours, repaired = tmp_path / "ours.mcap", tmp_path / "repaired.mcap"
    grid = ["--grid=x=-0.1:0.1:21", "--grid=y=-0.1:0.1:21", "--quiet"]
    subprocess.run([opm, "workspace", "plano-spherical-5dof", *grid, "-o", ours], check=True, stdout=subprocess.DEVNULL)
    _, found, _ = inspect(opm, ours)
    assert found["complete"]
    with open(repaired, "wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_metadata("run", found["metadata"]["run"])
        writer.finish()
    _, found, said = inspect(opm, repaired)
    assert not found["complete"] and "cut short" in said
