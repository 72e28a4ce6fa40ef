"""Pictures: what is drawn, where it is; and that the paper's figures can be drawn."""

import runpy
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import opm_kinematics as opm
import pytest
from opm_kinematics import plot
from shipped import LINKAGES

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def test_solids_are_where_the_geometry_puts_them(manipulator):
    """The two-link arm of leg 4: D = (0, 75) mm, b1 = b2 = 100 mm, its end at P."""
    pose = np.array([0.03, -0.02, 0.2, 0.3, 0.1])
    rods = {s.body: s for s in manipulator.solids(pose.tolist()) if s.body.startswith("leg4/") and s.material == "link"}
    first = [s.ends for s in manipulator.solids(pose.tolist()) if s.body == "leg4/phi14" and s.shape == "cylinder"]
    joints = manipulator.inverse([pose])
    phi14 = joints["phi14"][0]
    elbow = np.array([0.1 * np.cos(phi14), 0.075 + 0.1 * np.sin(phi14), 0])
    ends = np.vstack(first)
    assert rods and np.linalg.norm(ends - [0, 0.075, 0], axis=1).min() < 1e-12
    assert np.linalg.norm(ends[:, :2] - elbow[:2], axis=1).min() < 1e-12
    with pytest.raises(opm.OpmError, match="is out of reach of leg1"):
        manipulator.solids([1.0, 0, 0, 0, 0])


@pytest.mark.parametrize("name", [n for n in opm.examples.names() if n not in LINKAGES])
def test_every_mechanism_can_be_drawn(name):
    manipulator = opm.examples.load(name)
    panel = plot.mechanism(manipulator)
    panel.figure.canvas.draw()
    ends = np.vstack([s.ends for s in manipulator.solids() if s.body != "base"])
    low, high = np.array([panel.get_xlim(), panel.get_ylim(), panel.get_zlim()]).T
    assert (ends >= low - 1e-12).all() and (ends <= high + 1e-12).all()


def test_faces_look_outward(manipulator):
    for solid in manipulator.solids():
        middle = solid.ends.mean(axis=0)
        for face in plot._faces(solid):
            normal = np.cross(face[1] - face[0], face[2] - face[1])
            assert normal @ (face.mean(axis=0) - middle) > -1e-15


def test_kinds_are_drawn_with_their_boundary(manipulator):
    tilt = (-0.2, 0.2, 3)
    grid = {"x": (-0.25, 0.25, 41), "y": (-0.25, 0.25, 31), "zeta": tilt, "xi": tilt}
    dexterous = opm.sweep(manipulator, kind="dexterous", **grid)
    for x, y in (("x", "y"), ("y", "x")):
        (panel,) = plot.workspace(dexterous, x, y)
        image = panel.collections[0].get_array()
        share = opm.sweep(manipulator, **grid).mask().mean(axis=(2, 3, 4))
        np.testing.assert_allclose(image.reshape(share.T.shape if x == "x" else share.shape), share.T if x == "x" else share)
        rings = dexterous.boundary()[0].rings
        drawn = [line.get_xydata() for line in panel.lines]
        assert len(drawn) == len(rings) > 0
        for line, ring in zip(drawn, rings, strict=True):
            np.testing.assert_array_equal(line, ring if x == "x" else ring[:, ::-1])
    # A panel for each value of a third coordinate has the outline of that value; means have none.
    level = opm.sweep(manipulator, kind="lower", x=(-0.4, 0.4, 31), y=(-0.4, 0.4, 27), theta11=(-0.5, 1.0, 4))
    panels = plot.workspace(level, slices="theta11", values=[0.0, 1.0])
    for panel, number in zip(panels, (1, 3), strict=True):
        rings = level.boundary()[number].rings
        assert [len(line.get_xydata()) for line in panel.lines] == [len(ring) for ring in rings]
    assert not plot.workspace(level)[0].lines and not plot.workspace(opm.sweep(manipulator, **grid))[0].lines


def test_slices_are_those_of_the_mask(manipulator):
    swept = opm.sweep(manipulator, x=(-0.2, 0.2, 21), y=(-0.15, 0.15, 16), xi=(0, 1.2, 5), zeta=(-0.3, 0.3, 3))
    panels = plot.workspace(swept, slices="xi", values=[0.0, 0.9])
    assert [panel.get_title() for panel in panels] == ["xi = 0 rad", "xi = 0.9 rad"]
    mask = swept.mask()
    for panel, number in zip(panels, (0, 3), strict=True):
        image = panel.collections[0].get_array().reshape(16, 21)
        np.testing.assert_allclose(image, mask[:, :, :, number, 0].mean(axis=2).T)
    (panel,) = plot.workspace(swept, "zeta", "xi", ax=plt.figure().add_subplot())
    image = panel.collections[0].get_array().reshape(5, 3)
    np.testing.assert_allclose(image, mask.mean(axis=(0, 1, 4)).T)
    whole = opm.sweep(opm.examples.load("translational-helical-3dof"), x=(-1, 1, 5), y=(-1, 1, 4), phi=(0, 1, 3))
    image = plot.workspace(whole, slices="phi")[2].collections[0].get_array().reshape(4, 5)
    np.testing.assert_array_equal(image, whole.mask()[:, :, 2].T)


def test_curves_are_those_of_the_joints(manipulator):
    followed = opm.trajectory(manipulator, "plano-spherical-sinusoids", rate=10)
    lengths, angles = plot.joints(followed, ["S1", "theta11", "phi24"])
    np.testing.assert_array_equal(lengths.lines[0].get_ydata(), followed["S1"])
    np.testing.assert_array_equal(angles.lines[1].get_ydata(), followed["phi24"])
    assert (lengths.get_ylabel(), angles.get_ylabel()) == ("m", "rad")
    (rates,) = plot.joints(followed, rates=True)
    np.testing.assert_array_equal(rates.lines[2].get_ydata(), followed.imaginary_rates[:, 2])
    solutions = manipulator.inverse(followed.poses)
    (panel,) = plot.joints(solutions, ["S2"], times=followed.times)
    np.testing.assert_array_equal(panel.lines[0].get_ydata(), solutions["S2"])


def test_the_imaginary_workspace_is_of_poses_within_limits(manipulator):
    poses = np.random.default_rng(8).uniform(-0.4, 0.4, (300, 5))
    solutions = manipulator.inverse(poses)
    panel = plot.imaginary(solutions, ["theta11", "theta13"], color=poses[:, 3])
    drawn = panel.collections[0].get_offsets()
    np.testing.assert_array_equal(drawn, solutions.imaginary[solutions.within_limits][:, [0, 2]])
    assert plot.imaginary(solutions).name == "3d"


def test_wrong_input_is_told(manipulator):
    swept = opm.sweep(manipulator, x=(-0.2, 0.2, 3))
    with pytest.raises(opm.OpmError, match="y is not given, and no coordinate is left"):
        plot.workspace(swept)
    with pytest.raises(opm.OpmError, match="w: no such coordinate"):
        plot.workspace(swept, "x", "w")
    with pytest.raises(opm.OpmError, match="expected different coordinates"):
        plot.workspace(swept, "x", "y", slices="x")
    with pytest.raises(opm.OpmError, match="2 axes to draw on, expected 1"):
        plot.workspace(swept, "x", "y", ax=plt.subplots(1, 2)[1])
    solutions = manipulator.inverse(np.zeros((4, 5)))
    with pytest.raises(opm.OpmError, match=r"times of shape \(0,\)"):
        plot.joints(solutions)
    with pytest.raises(opm.OpmError, match="one working mode"):
        plot.joints(manipulator.inverse(np.zeros((4, 5)), mode="all"), times=np.arange(4.0))
    with pytest.raises(opm.OpmError, match="1 imaginary joints, expected two or three"):
        plot.imaginary(solutions, ["theta11"])
    with pytest.raises(KeyError, match="S9"):
        plot.joints(solutions, ["S9"], times=np.arange(4.0))


def test_without_matplotlib_it_says_what_to_install(tmp_path):
    (tmp_path / "matplotlib.py").write_text("raise ImportError('none')")
    code = "import opm_kinematics as o; m = o.examples.load('plano-spherical-5dof'); o.plot.mechanism(m)"
    done = subprocess.run(
        [sys.executable, "-c", code], env={"PYTHONPATH": str(tmp_path)}, capture_output=True, text=True, check=False
    )
    assert "pip install 'opm-kinematics[plot]'" in done.stderr


def test_the_command_line_does_not_wait_for_numpy():
    code = "import opm_kinematics.__main__, sys; assert 'numpy' not in sys.modules and 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_figures_of_the_paper_can_be_drawn(tmp_path):
    example = runpy.run_path(str(EXAMPLES / "paper_figures.py"))
    example["main"](tmp_path)
    drawn = sorted(path.name for path in tmp_path.iterdir())
    assert drawn == sorted(f"figure_{n}.png" for n in (4, 7, 8, 9, 10, 11, 13, 14, 15, 16, 17))
    for path in tmp_path.iterdir():
        # Something is on it: white is not all there is.
        assert np.mean(plt.imread(path)[:, :, :3].min(axis=2) < 0.9) > 0.005, path.name


def test_the_upper_section_of_figure_11_is_what_spherical_geometry_says(manipulator):
    """At zeta = 0 the coaxial 3-RRR section closes while every axis w of the platform is more than 30 degrees from -z
    (alpha_1 = alpha_2 = 75 degrees)."""
    swept = opm.sweep(manipulator, kind="upper", zeta=0.0, xi=(0.0, np.pi, 91), psi=(-np.pi, np.pi, 181))
    xi, psi = np.meshgrid(swept.axes["xi"], swept.axes["psi"], indexing="ij")
    beta = np.radians(60)
    axes = [np.cos(xi) * np.cos(beta) - np.sin(xi) * np.sin(beta) * np.cos(psi + eta) for eta in np.radians([0, 120, 240])]
    margin = np.min(axes, axis=0) - np.cos(np.radians(150))
    sure = np.abs(margin) > 1e-9
    assert sure.mean() > 0.99 and 0.2 < (margin > 0).mean() < 0.9
    np.testing.assert_array_equal(swept.mask()[0][sure], (margin > 0)[sure])


def test_every_value_of_the_slices_is_drawn_or_it_says_so(manipulator):
    seven = opm.sweep(manipulator, x=(-0.1, 0.1, 5), y=(-0.1, 0.1, 5), xi=(-0.6, 0.6, 7))
    panels = plot.workspace(seven, slices="xi")
    assert len(panels) == 7 and panels[-1].get_title() == "xi = 0.6 rad" and panels[0].figure.get_suptitle() == ""
    many = opm.sweep(manipulator, x=(-0.1, 0.1, 5), y=(-0.1, 0.1, 5), xi=(-0.6, 0.6, 25))
    panels = plot.workspace(many, slices="xi")
    assert (len(panels), panels[0].figure.get_suptitle()) == (12, "12 of 25 values of xi")
    assert (panels[0].get_title(), panels[-1].get_title()) == ("xi = -0.6 rad", "xi = 0.6 rad")


def test_shares_have_a_colour_bar(manipulator):
    labels = lambda panels: [a.get_ylabel() for a in panels[0].figure.axes if a not in panels]  # noqa: E731
    swept = opm.sweep(manipulator, x=(-0.1, 0.1, 5), y=(-0.1, 0.1, 5), xi=(-0.6, 0.6, 3), psi=(-0.6, 0.6, 3))
    assert labels(plot.workspace(swept)) == ["share of the values of xi, psi"]
    assert labels(plot.workspace(swept, slices="xi")) == ["share of the values of psi"]
    plane = opm.sweep(manipulator, x=(-0.1, 0.1, 5), y=(-0.1, 0.1, 5))
    assert labels(plot.workspace(plane)) == []
    panel = plt.figure().add_subplot()
    plot.workspace(swept, ax=panel)
    assert panel.figure.axes == [panel]


def cut(figure):
    """How far what is drawn stands out of its figure, inches: left, below, right, above."""
    figure.canvas.draw()
    drawn, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    # A hundredth of an inch is a pixel.
    return [out for out in (-drawn.x0, -drawn.y0, drawn.x1 - width, drawn.y1 - height) if out > 0.01]


def test_no_label_is_cut(manipulator):
    wide = opm.sweep(manipulator, x=(-0.4, 0.4, 9), y=(-0.02, 0.02, 5))
    high = opm.sweep(manipulator, x=(-0.002, 0.002, 5), y=(-0.2, 0.2, 9), xi=(-0.2, 0.2, 7))
    turned = opm.sweep(manipulator, zeta=(-1.2345, 1.2345, 7), psi=(-1e-4, 1e-4, 5))
    for panels in (plot.workspace(wide), plot.workspace(high), plot.workspace(high, slices="xi"), plot.workspace(turned)):
        assert cut(panels[0].figure) == []
    # Also where somebody has made the figure, however small, but has not laid it out.
    for size in ((6.4, 4.8), (3, 3), (4, 3)):
        for swept in (wide, turned):
            panel = plt.figure(figsize=size).add_subplot()
            plot.workspace(swept, ax=panel)
            assert cut(panel.figure) == []
    figure = plt.figure()
    figure.subplots_adjust(left=0.3)
    plot.workspace(wide, ax=figure.add_subplot())
    assert figure.get_layout_engine() is None and figure.subplotpars.left == 0.3
    followed = opm.trajectory(manipulator, "plano-spherical-sinusoids", rate=10)
    assert cut(plot.joints(followed)[0].figure) == []


def corners(polygons):
    """(n, 3): the corners of the polygons that are drawn, which releases of matplotlib keep in different places."""
    faces = getattr(polygons, "_faces", None)
    return polygons._vec[:3].T if faces is None else np.asarray(faces).reshape(-1, 3)


def test_guides_are_drawn_as_far_as_the_box():
    """In this mechanism they are 800 mm long, and everything else is within some 80 mm."""
    panel = plot.mechanism(opm.examples.load("translational-helical-3dof"))
    drawn = corners(panel.collections[0])
    low, high = np.array([panel.get_xlim(), panel.get_ylim(), panel.get_zlim()]).T
    # But for the thickness of a rod, which stands out of the box where it enters slantwise.
    assert (drawn > low - 0.005).all() and (drawn < high + 0.005).all() and (high - low).max() < 0.3


@pytest.mark.parametrize("name", [n for n in opm.examples.names() if n not in LINKAGES])
def test_a_mechanism_fills_its_picture(name):
    manipulator = opm.examples.load(name)
    panel = plot.mechanism(manipulator)
    assert cut(panel.figure) == []
    # What is drawn without the axes is a good part of that, and not a few threads.
    panel.set_axis_off()
    panel.figure.canvas.draw()
    ink = np.asarray(panel.figure.canvas.buffer_rgba())[:, :, :3].min(axis=2) < 245
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    spread = (np.ptp(rows) + 1) / ink.shape[0], (np.ptp(columns) + 1) / ink.shape[1]
    assert max(spread) > 0.3 and ink.mean() > 0.008, (spread, ink.mean())


def test_a_mechanism_is_drawn_by_its_method(manipulator):
    pose = [0.03, -0.02, 0.2, 0.3, 0.1]
    by_method, by_function = manipulator.plot(pose), plot.mechanism(manipulator, pose)
    np.testing.assert_array_equal(corners(by_method.collections[0]), corners(by_function.collections[0]))
    panel = plt.figure().add_subplot(projection="3d")
    assert manipulator.plot(mode="-+ ++ ++ +", ax=panel) is panel
    with pytest.raises(opm.OpmError, match="out of reach of leg"):
        manipulator.plot([1.0, 0, 0, 0, 0])


def test_a_motion_is_animated(manipulator, tmp_path):
    followed = opm.trajectory(manipulator, "plano-spherical-sinusoids", rate=50)
    moving = manipulator.animate(followed, frames=5)
    np.testing.assert_allclose(moving.times, np.linspace(followed.times[0], followed.times[-1], 5), atol=0.5 / 50)
    page = moving._repr_html_()
    assert page.count("data:image/png;base64") == 5 and "<script" in page and "http" not in page and "fa-" not in page
    assert "out of reach" not in page
    named = manipulator.animate("plano-spherical-sinusoids", frames=3)
    assert named.times[-1] == followed.times[-1]
    named.save(tmp_path / "motion.gif")
    named.save(tmp_path / "motion.html")
    assert (tmp_path / "motion.gif").read_bytes()[:3] == b"GIF" and "<script" in (tmp_path / "motion.html").read_text()
    # Each picture is that of its pose; all of them have the same axes.
    panel = plt.figure().add_subplot(projection="3d")
    poses = np.array([[0.0, 0, 0, 0.2, 0], [0.05, 0, 0, 0.2, 0], [9.0, 0, 0, 0, 0]])
    moving = manipulator.animate(poses, ax=panel)
    np.testing.assert_allclose(moving.times, [0, 0.1, 0.2])
    limits = panel.get_xlim()
    for number, shown in ((0, 0), (1, 1), (2, 1)):
        (drawn,) = moving._show(number)
        expected = plot.mechanism(manipulator, poses[shown]).collections[0]
        # All pictures have one box, as far as which the guides on the base are drawn.
        of_mechanism = [solid.body != "base" for solid in manipulator.solids(poses[shown]) for _ in plot._faces(solid)]
        count = 4 * sum(of_mechanism)
        np.testing.assert_allclose(corners(drawn)[-count:], corners(expected)[-count:])
        assert ("out of reach" in panel.get_title()) == (number == 2) and panel.get_xlim() == limits


def test_what_cannot_be_animated_is_told(manipulator):
    for poses, message in [(np.full((3, 5), 9.0), "0 of them in reach"), (np.zeros((1, 5)), "1 poses")]:
        with pytest.raises(opm.OpmError, match=message):
            manipulator.animate(poses)
    with pytest.raises(opm.OpmError, match="frames is 1, expected at least 2"):
        manipulator.animate("plano-spherical-sinusoids", frames=1)
    with pytest.raises(OSError, match="nosuch"):
        manipulator.animate("nosuch")
    followed = opm.trajectory(manipulator, "plano-spherical-sinusoids", rate=10)
    with pytest.raises(opm.OpmError, match="followed in"):
        manipulator.animate(followed, mode="-+ ++ ++ +")


def test_what_is_no_result_is_told(manipulator):
    swept = opm.sweep(manipulator, x=0.0)
    for call in (lambda: plot.imaginary(swept), lambda: plot.workspace(3), lambda: plot.joints(3), lambda: plot.mechanism(swept)):
        with pytest.raises(TypeError, match="expected a (Solutions|Sweep|Trajectory or a Solutions|Manipulator)"):
            call()
