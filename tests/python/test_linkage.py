"""`opm linkage --sweep` recordings, decoded with public decoders, compared with its CSV."""

import csv
import json
import subprocess

import check_recording
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

MECHANISM = "bennett-double-spherical-6r"
START, ROUND = 1, 10_000_000_000  # nanoseconds


def run(opm, *arguments, mechanism=MECHANISM):
    command = [opm, "linkage", mechanism, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True)


# A crank, joints with a limited range, and an imaginary joint that is a slider.
@pytest.mark.parametrize(
    "mechanism, joint, turns",
    [
        (MECHANISM, "a1", True),
        (MECHANISM, "b1", False),
        ("bennett-plano-spherical-6r", "a1", True),
        ("sarrus", "a1", False),
    ],
)
def test_a_recording_holds_the_rows_of_the_csv(opm, tmp_path, mechanism, joint, turns):
    sweep = ["--input", joint, "--sweep", "--count", "101"]
    path = tmp_path / "round.mcap"
    run(opm, *sweep, "-o", path, mechanism=mechanism)
    rows = list(csv.DictReader(run(opm, *sweep, mechanism=mechanism).stdout.splitlines()))
    check_recording.doctor(path)

    joints, imaginary = [], []
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for schema, channel, record, message in reader.iter_decoded_messages():
            assert schema.name == message.DESCRIPTOR.full_name
            if channel.topic not in ("/joints", "/imaginary_joints"):
                continue
            values = [getattr(message, field.name) for field in message.DESCRIPTOR.fields]
            names = [field.name for field in message.DESCRIPTOR.fields]
            {"/joints": joints, "/imaginary_joints": imaginary}[channel.topic].append(
                (record.log_time, dict(zip(names, values)))
            )
        names = next(m.metadata for m in reader.iter_metadata() if m.name == "joints")
        result = next(m.metadata for m in reader.iter_metadata() if m.name == "result")
    assert result["complete"] == "true" and result["turns"] == str(turns).lower()
    assert names["tau_leg1"] == "tau.leg1"
    assert len(joints) == len(imaginary) == len(rows) == 101
    for number, (row, one, two) in enumerate(zip(rows, joints, imaginary)):
        assert one[0] == two[0] == START + number * ROUND // 100
        # Both are the same doubles: the CSV has all their digits.
        recorded = {names[field]: value for field, value in (one[1] | two[1]).items()}
        assert recorded == {name: float(row[name]) for name in recorded}
    assert (float(rows[-1][joint]) - float(rows[0][joint]) > 6) == turns


def test_every_position_of_the_csv_is_one_that_is_found_alone(opm):
    rows = list(csv.DictReader(run(opm, "--sweep", "--count", "13").stdout.splitlines()))
    for row in rows:
        value = f"a1={row['a1']}"
        answer = json.loads(run(opm, "--input", value, "--format", "json").stdout)
        assert answer["full_turn"] and len(answer["solutions"]) == 4
        [same] = [s for s in answer["solutions"] if s["branch"] == row["branch"]]
        for name, angle in (same["joints"] | same["imaginary"]).items():
            turns = (float(row[name]) - angle) / 6.283185307179586
            assert abs(turns - round(turns)) < 1e-12
