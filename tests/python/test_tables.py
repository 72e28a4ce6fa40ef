"""Points as tables, read by NumPy and plyfile and compared with the recording of the same run."""

import subprocess

import numpy as np
import pytest
from check_recording import points
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from plyfile import PlyData

PLANO = "plano-spherical-5dof"
GRID = ["--grid", "x=-0.25:0.25:41", "--grid", "y=-0.2:0.2:9", "--grid", "xi=-1.7:1.7:7"]
FLAGS = ["--axes", "x,y,xi", "--scalars", "theta11,S1", "--color", "xi"]


@pytest.fixture(scope="module")
def record(opm, tmp_path_factory):
    folder = tmp_path_factory.mktemp("tables")

    def run(ending, *flags):
        path = folder / f"points.{ending}"
        command = [opm, "workspace", PLANO, *GRID, "-o", path, "--quiet", *flags]
        subprocess.run(command, check=True, capture_output=True)
        return path

    return run


@pytest.fixture(scope="module")
def cloud(record):
    with open(record("mcap", *FLAGS, "--scale", "none"), "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        slices = [points(m) for *_, m in reader.iter_decoded_messages(topics="/workspace/slices")]
    cloud = np.concatenate(slices)
    assert len(cloud) > 100
    return cloud


def test_an_array_has_the_points_in_double_precision(record, cloud):
    array = np.load(record("npy", *FLAGS), mmap_mode="r")
    assert array.dtype.names == ("x", "y", "xi", "theta11", "S1")
    assert all(array.dtype[name] == np.float64 for name in array.dtype.names)
    for name, field in zip(array.dtype.names, ("x", "y", "z", "theta11", "S1"), strict=True):
        np.testing.assert_array_equal(array[name].astype(np.float32), cloud[field])
    # The values of the grid, in double precision.
    assert set(array["y"]) <= {-0.2 * (1 - i / 8) + 0.2 * (i / 8) for i in range(9)}


def test_a_mesh_tool_reads_the_cloud(record, cloud):
    ply = PlyData.read(record("ply", *FLAGS))
    vertices = ply["vertex"].data
    assert vertices.dtype.names == cloud.dtype.names
    for name in cloud.dtype.names:
        np.testing.assert_array_equal(vertices[name], cloud[name])
    assert "mechanism: plano-spherical-5dof" in ply.comments


@pytest.mark.parametrize("ending", ["npy", "ply"])
def test_tables_without_flags_or_points(record, cloud, ending):
    path = record(ending)
    table = np.load(path) if ending == "npy" else PlyData.read(path)["vertex"].data
    assert len(table) == len(cloud)
    assert {"zeta", "psi"} <= set(table.dtype.names)
    if ending == "npy":  # The columns that vary, then the constant ones.
        assert table.dtype.names == ("x", "y", "xi", "zeta", "psi")
    path = record(ending, "--grid", "zeta=0", "--mode", "home", "--max-condition", "1")
    count = len(np.load(path) if ending == "npy" else PlyData.read(path)["vertex"].data)
    assert count == 0
