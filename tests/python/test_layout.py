"""`opm layout`: what it names is in the recording, and what is in the recording is in view."""

import ast
import json
import math
import subprocess
import sys

import numpy as np
import pytest
from check_recording import points
from test_motion_recording import Recorded

RECORDINGS = {
    "motion": ["trajectory", "plano-spherical-5dof", "--motion", "plano-spherical-sinusoids"],
    "dependent": ["trajectory", "five-bar", "--motion", "MOTION"],
    "linkage": ["linkage", "bennett-double-spherical-6r", "--sweep", "--count", "51"],
    "workspace": ["workspace", "plano-spherical-5dof", "--grid", "x=-0.2:0.2:21", "--grid", "y=-0.2:0.2:21"]
    + ["--grid", "xi=-0.6:0.6:5", "--shape"],
    "plane": ["workspace", "planar-3rrr", "--grid", "x=-0.1:0.1:21", "--grid", "y=-0.1:0.1:21"],
    "explained": ["workspace", "planar-3rrr", "--grid", "x=-0.3:0.3:21", "--grid", "y=-0.1:0.3:21", "--explain"],
    "set": ["workspace", "planar-3rrr", "--kind", "reachable", "--grid", "x=-0.1:0.1:21", "--grid", "y=-0.1:0.1:21"]
    + ["--grid", "theta=-10deg:10deg:5"],
}
MOTION = """
format = 1
name = "swing"
units = { length = "mm", angle = "deg" }
duration = 1
rate = 50
[coordinates]
x = { amplitude = 20, frequency = 1 }
"""


@pytest.fixture(scope="module")
def recordings(opm, tmp_path_factory):
    folder = tmp_path_factory.mktemp("layout")
    motion = folder / "swing.toml"
    motion.write_text(MOTION)
    found = {}
    for name, command in RECORDINGS.items():
        found[name] = folder / f"{name}.mcap"
        command = [motion if word == "MOTION" else word for word in command]
        done = subprocess.run([opm, *command, "-o", found[name]], check=True, capture_output=True, text=True)
        assert f"`opm layout {found[name]} -o layout.json`" in done.stderr
    return found


def leaves(tree):
    if isinstance(tree, str):
        return [tree]
    assert set(tree) == {"first", "second", "direction", "splitPercentage"}
    assert tree["direction"] in ("row", "column") and 0 < tree["splitPercentage"] < 100
    return [*leaves(tree["first"]), *leaves(tree["second"])]


def shown(recorded, *, rejected=False):
    """Every point in space, in the frame of the view: of what is there, or of what is rejected."""
    clouds = {
        topic: np.stack([points(message)[axis] for axis in "xyz"], axis=-1)
        for topic, messages in recorded.topics.items()
        if topic.startswith(("/workspace/", "/scene/bodies/")) and topic != "/workspace/boundary_points"
        for _, message in messages
        if message.DESCRIPTOR.name == "PointCloud" and (topic == "/workspace/rejected") == rejected
    }
    if "/tf" not in recorded.topics:
        return np.concatenate(list(clouds.values()))
    moved = [
        clouds[f"/scene/bodies/{frame}"] @ place[:3, :3].T + place[:3, 3]
        for frames in recorded.frames()
        for frame, place in frames.items()
    ]
    return np.concatenate(moved)


@pytest.mark.parametrize("name", RECORDINGS)
def test_a_layout_shows_the_recording(opm, recordings, name):
    path = recordings[name]
    recorded = Recorded(path)
    layout = json.loads(subprocess.run([opm, "layout", path], check=True, capture_output=True).stdout)
    assert set(layout) == {"configById", "globalVariables", "userNodes", "playbackConfig", "layout"}
    assert layout["playbackConfig"] == {"speed": 1}
    panels = layout["configById"]
    assert sorted(leaves(layout["layout"])) == sorted(panels)

    views = [panel for key, panel in panels.items() if key.startswith("3D!")]
    assert len(views) == (2 if name in ("workspace", "explained") else 1)
    for view in views:
        at = shown(recorded, rejected=view["topics"].get("/workspace/rejected", {}).get("visible", False))
        assert (view["followMode"], view["followTf"]) == ("follow-none", "base" if "/tf" in recorded.topics else "task")
        camera = view["cameraState"]
        assert camera["target"] == camera["targetOffset"]
        farthest = np.linalg.norm(at - camera["target"], axis=1).max()
        # The ball round the target is within the camera's angle, and between its planes.
        assert farthest <= 1.01 * camera["distance"] * math.sin(math.radians(camera["fovy"] / 2))
        assert camera["near"] < camera["distance"] - farthest and camera["far"] > camera["distance"] + farthest
        assert farthest > 0.2 * camera["distance"], "it is a speck"
        assert view["scene"]["transforms"]["showLabel"] is False and view["scene"]["transforms"]["axisScale"] == 0
        assert set(view["topics"]) <= set(recorded.topics)
        for topic, settings in view["topics"].items():
            assert settings["visible"] in (True, False)
            if settings["visible"] and recorded.topics[topic][0][1].DESCRIPTOR.name == "PointCloud":
                assert settings["colorMode"] == "rgba-fields" and settings["pointSize"] > 0
    visible = {topic for view in views for topic, settings in view["topics"].items() if settings["visible"]}
    named = {topic for view in views for topic in view["topics"]}
    drawn = {topic for topic in recorded.topics if topic.startswith(("/workspace/", "/scene"))}
    drawn -= {"/workspace/slice"}
    assert named == drawn
    assert not any(topic.startswith("/scene/bodies/") for topic in visible)
    assert visible >= {topic for topic in ["/scene", "/workspace/cloud", "/workspace/boundary"] if topic in drawn}

    plots = [panel for key, panel in panels.items() if key.startswith("Plot!")]
    paths = [line["value"] for plot in plots for line in plot["paths"]]
    expected = [
        f"{topic}.{field.name}"
        for topic in ["/pose", "/dependent_coordinates", "/joints", "/imaginary_joints"]
        if topic in recorded.topics
        for field in recorded.topics[topic][0][1].DESCRIPTOR.fields
    ] + ["/condition.condition"] * ("/condition" in recorded.topics)
    assert sorted(paths) == sorted(expected)
    for plot in plots:
        assert plot["xAxisVal"] == "timestamp"
        for line in plot["paths"]:
            field = line["value"].rpartition(".")[2]
            assert line["label"] == recorded.metadata["joints"].get(field, field)
            assert plot["yAxisLabel"] == recorded.metadata["quantities"].get(field, "")
    logs = [panel["topicToRender"] for key, panel in panels.items() if key.startswith("RosOut!")]
    assert logs == ["/violations"] * ("/joints" in recorded.topics)


@pytest.mark.parametrize("name", RECORDINGS)
def test_a_script_shows_the_recording_in_rerun(opm, recordings, name):
    path = recordings[name]
    script = path.with_name(f"{name}.py")
    subprocess.run([opm, "layout", path, "-o", script], check=True, capture_output=True)
    tree = ast.parse(script.read_text())
    recorded = Recorded(path)
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)]
    plotted = [tuple(map(ast.literal_eval, call.args)) for call in calls if call.func.id == "curves"]
    colour = next(node for node in tree.body if isinstance(node, ast.Assign) and node.targets[0].id == "COLOURS")
    colours = ast.literal_eval(colour.value)
    assert len(set(colours)) == len(colours) >= 7
    for _, topic, schema, names in plotted:
        descriptor = recorded.topics[topic][0][1].DESCRIPTOR
        assert descriptor.full_name == schema
        assert set(names) <= {field.name for field in descriptor.fields}
    views = [tuple(map(ast.literal_eval, call.args)) for call in calls if call.func.id == "space"]
    assert len(views) == (2 if name in ("workspace", "explained") else 1)
    for _, topics, _, _ in views:
        assert all(topic in recorded.topics or topic in ("/scene/bodies/**", "/box/**") for topic in topics)
    pytest.importorskip("rerun", reason="rerun-sdk is not installed")
    saved = path.with_suffix(".rrd")
    subprocess.run([sys.executable, script, saved], check=True)
    assert saved.stat().st_size > 1000
    # Times are durations from the start on, not dates of 1970.
    command = [sys.executable, "-m", "rerun_cli", "rrd", "print", "-vv", saved]
    printed = subprocess.run(command, capture_output=True, text=True).stdout
    assert "index_name: message_log_time" in printed and "Duration(ns)" in printed


def test_what_has_no_layout(opm, recordings, tmp_path):
    def refused(*arguments):
        done = subprocess.run([opm, "layout", *arguments], capture_output=True, text=True)
        assert done.returncode in (1, 2) and len(done.stderr.strip().splitlines()) == 1, done.stderr
        return done.stderr

    assert "expected a name that ends in .json" in refused(recordings["plane"], "-o", tmp_path / "layout.txt")
    assert "No such file" in refused(tmp_path / "none.mcap")
    text = tmp_path / "text.mcap"
    text.write_text("no recording")
    assert "not an MCAP file" in refused(text)
    shard = tmp_path / "part.mcap"
    command = [opm, "workspace", "planar-3rrr", "--grid", "x=-0.1:0.1:21", "--shard", "1/2", "-o", shard]
    subprocess.run(command, check=True, capture_output=True)
    assert "expected a workspace or a motion" in refused(shard)
