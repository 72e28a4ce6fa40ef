"""Checks a workspace recording with decoders that this project did not write.

    python check_recording.py RECORDING... [--points EXPECTED.csv]

`pymcap-cli doctor` must find nothing wrong, and the clouds, decoded by `mcap-protobuf-support`, must
be what docs/recordings.md says. With `--points`, the slices together must hold exactly the rows of the
CSV file, in its order: columns x, y, z and any of the scalars, in SI units and radians.
"""

import argparse
import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

OVERVIEW, SLICES, AXES = "/workspace/cloud", "/workspace/slices", "/workspace/axes"
SLICE, LABEL = "/workspace/slice", "/workspace/label"
START, SLICE_STEP = 1_000_000_000, 100_000_000  # nanoseconds
MAX_OVERVIEW_POINTS, MAX_MESSAGE_POINTS = 2_000_000, 4_000_000
COLORS = ["red", "green", "blue", "alpha"]
# `foxglove.PackedElementField.NumericType`
NUMERIC_TYPES = {1: "u1", 2: "i1", 3: "<u2", 4: "<i2", 5: "<u4", 6: "<i4", 7: "<f4", 8: "<f8"}
# A float32 is within half a unit in its last place; the expected value may be rounded once more.
RELATIVE, ABSOLUTE = 2.0**-23, 1e-12
# Luminance (0 to 255) may vary by this along the colour map, by rounding to bytes.
LUMINANCE_WAVER = 1.5


class Failure(Exception):
    """A recording does not meet a requirement."""


def require(condition, what):
    if not condition:
        raise Failure(what)


def doctor(path):
    command = [Path(sys.executable).with_name("pymcap-cli"), "doctor", path]
    result = subprocess.run(command, capture_output=True, text=True)
    require(result.returncode == 0, f"pymcap-cli doctor:\n{result.stdout}{result.stderr}")


def points(cloud):
    """The points of a decoded `foxglove.PointCloud` as a structured array."""
    layout = np.dtype(
        {
            "names": [field.name for field in cloud.fields],
            "formats": [NUMERIC_TYPES[field.type] for field in cloud.fields],
            "offsets": [field.offset for field in cloud.fields],
            "itemsize": cloud.point_stride,
        }
    )
    return np.frombuffer(cloud.data, layout)


def check_cloud(topic, message, cloud, scalars):
    """Checks one message: its frame, its time stamps, its fields and its numbers."""
    at = f"{topic} at {message.log_time} ns"
    stamp = cloud.timestamp.seconds * 1_000_000_000 + cloud.timestamp.nanos
    require(stamp == message.log_time == message.publish_time, f"{at}: stamped {stamp} ns")
    require(cloud.frame_id != "", f"{at}: no frame")
    require(cloud.pose.orientation.w == 1, f"{at}: no pose")
    floats = ["x", "y", "z", *scalars]
    fields = [(field.name, field.offset, field.type) for field in cloud.fields]
    expected = [(name, 4 * i, 7) for i, name in enumerate(floats)]
    expected += [(name, 4 * len(floats) + i, 1) for i, name in enumerate(COLORS)]
    require(fields == expected, f"{at}: fields {fields}, expected {expected}")
    require(len(cloud.data) % cloud.point_stride == 0, f"{at}: a part of a point")
    array = points(cloud)
    for name in floats:
        require(np.isfinite(array[name]).all(), f"{at}: {name} is not finite")
    require((array["alpha"] == 255).all(), f"{at}: not opaque")
    return array


def scales(clouds):
    """The factors of the axes."""
    return dict(zip("xyz", map(float, clouds["scale"].split(","))))


def unscaled(array, clouds):
    """The points with the values of their axes, before these were scaled."""
    array = array.copy()
    for axis, factor in scales(clouds).items():
        array[axis] = array[axis].astype(float) / factor
    return array


def check_box(scene, clouds):
    """Checks the labels of the box round the points, and returns its ends."""
    (entity,) = scene.entities
    (edges,) = entity.lines
    require(len(edges.points) == 24, f"{len(edges.points)} ends of edges")
    ends = []
    texts = [text.text for text in entity.texts]
    for (axis, factor), name, unit in zip(scales(clouds).items(), clouds["axes"].split(","), clouds["units"].split(",")):
        values = [getattr(point, axis) / factor for point in edges.points]
        ends.append([min(values), max(values)])
        labels = [text for text in texts if text.startswith(f"{name} = ") and text.endswith(f" {unit}")]
        told = sorted(float(label.removeprefix(f"{name} = ").removesuffix(f" {unit}")) for label in labels if unit)
        expected = sorted(set(ends[-1])) if unit else []
        require(np.allclose(told, expected, rtol=6e-3, atol=1e-9), f"labels {told} of {name}, expected {expected}")
    return ends


def check_colors(array, clouds):
    """Checks that larger values are lighter, and that the range covers the whole colour map."""
    axes = dict(zip(clouds["axes"].split(","), "xyz"))
    field = axes.get(clouds["color"], clouds["color"])
    if field not in array.dtype.names or len(array) == 0:
        return
    low, high = float(clouds["color_min"]), float(clouds["color_max"])
    luminance = array["red"] * 0.2126 + array["green"] * 0.7152 + array["blue"] * 0.0722
    luminance = luminance[np.argsort(array[field], kind="stable")]
    falls = np.maximum.accumulate(luminance) - luminance
    require(falls.max() <= LUMINANCE_WAVER, f"colours: luminance falls by {falls.max()}")
    if low < high and array[field].min() <= low and array[field].max() >= high:
        require(np.ptp(luminance) > 128, "colours: the range does not span the map")


def check_points(array, path):
    with open(path, newline="") as file:
        rows = csv.reader(file)
        header = next(rows)
        expected = np.array([[float(cell) for cell in row] for row in rows]).reshape(-1, len(header))
    require(len(array) == len(expected), f"{len(array)} points, expected {len(expected)}")
    for name, column in zip(header, expected.T):
        wrong = ~np.isclose(array[name], column, rtol=RELATIVE, atol=ABSOLUTE)
        first = int(np.argmax(wrong)) if wrong.any() else 0
        found = f"{name} of point {first} is {array[name][first]}" if wrong.any() else ""
        require(not wrong.any(), f"{found}, expected {column[first] if wrong.any() else ''}")


def check(path, expected=None):
    doctor(path)
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        metadata = list(reader.iter_metadata())
        require(metadata[-1].metadata.get("complete") == "true", "the last metadata: not complete")
        clouds = next(record.metadata for record in metadata if record.name == "clouds")
        scalars = [name for name in clouds["scalars"].split(",") if name]
        attachments = list(reader.iter_attachments())
        require(len(attachments) == 1 and attachments[0].data, "no mechanism file is attached")

        overview, slices, times, boxes = [], [], [], []
        number, told, words = None, {}, None
        for schema, channel, message, cloud in reader.iter_decoded_messages(log_time_order=False):
            if channel.topic == SLICE:
                number = int(cloud.slice)
                require(not told or max(told) <= number, "slices are out of order")
                told[number] = cloud
                continue
            if channel.topic == LABEL:
                words = cloud.entities[0].texts[0].text
                require(words.endswith(f": {int(told[number].count)} points"), words)
                continue
            if channel.topic == AXES:
                boxes.append(check_box(cloud, clouds))
                continue
            require(schema.name == "foxglove.PointCloud", f"{channel.topic}: {schema.name}")
            require(channel.topic in (OVERVIEW, SLICES), f"topic {channel.topic}")
            array = unscaled(check_cloud(channel.topic, message, cloud, scalars), clouds)
            require(not times or times[-1] <= message.log_time, "log_time goes back")
            times.append(message.log_time)
            if channel.topic == OVERVIEW:
                overview.append(array)
            else:
                require(len(array) > 0, f"slice {number} is empty")
                written = (message.log_time - START) // SLICE_STEP
                require(written == len(told) - 1, f"slice {number} is at {message.log_time} ns")
                slices.append((number, array))

    require(times[0] == START, f"the first message is at {times[0]} ns")
    require(len(overview) == 1, f"{len(overview)} overviews")
    require(len(overview[0]) <= MAX_OVERVIEW_POINTS, f"an overview of {len(overview[0])} points")
    numbers = [number for number, _ in slices]
    require(numbers == sorted(numbers) and set(numbers) == set(told), "slices are missing")
    require(max(numbers, default=0) < int(clouds["slices"]), "a slice is not of the grid")
    for number, message in told.items():
        count = sum(len(array) for of, array in slices if of == number)
        require(message.count == count, f"slice {number} has {count} points, and says {message.count}")
    require(all(len(array) <= MAX_MESSAGE_POINTS for _, array in slices), "a message is too large")
    everything = np.concatenate([array for _, array in slices] or [overview[0][:0]])
    require(len(everything) == int(clouds["points"]), f"{len(everything)} points in the slices")
    if len(overview[0]):
        found = [[float(overview[0][axis].min()), float(overview[0][axis].max())] for axis in "xyz"]
        require(len(boxes) == 1, f"{len(boxes)} boxes")
        near = np.allclose(boxes[0], found, rtol=RELATIVE, atol=ABSOLUTE)
        require(near, f"the box {boxes[0]}, expected {found}")
    else:
        require(not boxes, "a box round nothing")
    every = int(clouds["overview_every"])
    require(len(overview[0]) == int(clouds["overview_points"]), "the overview's points")
    chosen = everything[::every].copy()
    if int(clouds["slices"]) > 1:
        for color in COLORS[:3]:  # half grey
            chosen[color] = chosen[color] // 2 + 56
    require((overview[0] == chosen).all(), f"the overview is not every {every}th point")
    check_colors(everything, clouds)
    if expected:
        check_points(everything, expected)
    return len(everything), len(set(numbers))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("recordings", nargs="+", metavar="RECORDING")
    parser.add_argument("--points", metavar="EXPECTED.csv", help="what the slices must hold")
    arguments = parser.parse_args()
    failed = False
    for path in arguments.recordings:
        try:
            count, slices = check(path, arguments.points)
            print(f"{path}: {count} points in {slices} slices")
        except Exception as reason:  # any exception of a decoder is a finding about the file
            failed = True
            print(f"{path}: {type(reason).__name__}: {reason}", file=sys.stderr)
    sys.exit(failed)


if __name__ == "__main__":
    main()
