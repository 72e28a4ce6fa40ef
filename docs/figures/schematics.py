"""The joints of the mechanisms of docs/gallery at home, drawn from their files."""

import json
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from drawing import FAINT, INK, save
from recordings import REPOSITORY, opm

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

LOWER, UPPER, IMAGINARY = "#31688e", "#c8a000", "#c2185b"

# File, picture, view, and legs whose joints rotate about a centre, with the radius (mm) to draw them at.
DRAWN = (
    ("plano-spherical-5dof-joints", "plano-spherical", (40, -75), {"leg1": 60, "leg2": 60, "leg3": 60}),
    ("bennett-double-spherical-6r", "bennett", (24, -62), {"leg1": 70, "leg2": 70}),
    ("bennett-plano-spherical-6r", "bennett-plano-spherical", (24, -62), {"leg1": 70, "leg2": 70}),
    ("sarrus", "sarrus", (20, -50), {}),
    ("planar-planar-5dof-joints", "planar-planar", (26, -38), {}),
    ("double-spherical-5dof", "double-spherical", (18, -30), {"leg1": 110, "leg2": 110, "leg3": 110}),
    ("plano-cylindrical-4dof", "plano-cylindrical", (42, -72), {}),
    ("schoenflies-4dof", "schoenflies", (26, -58), {}),
    ("schoenflies-lift-4dof", "schoenflies-lift", (26, -58), {}),
    ("translational-helical-3dof-joints", "translational-helical", (34, -62), {}),
    ("translational-planar-4dof", "translational-planar", (24, -35), {}),
    ("planar-3rrr", "planar-3rrr", (58, -75), {}),
    ("planar-3rpr", "planar-3rpr", (58, -75), {}),
    ("agile-eye", "agile-eye", (22, 35), {"leg1": 48, "leg2": 60, "leg3": 72}),
    ("five-bar", "five-bar", (58, -75), {}),
    ("schoenflies-column-4dof", "schoenflies-column", (32, -60), {}),
    ("cartesian-wrist-6dof", "cartesian-wrist", (24, -35), {"leg1": 48, "leg2": 60, "leg3": 72}),
    ("orbita", "orbita", (18, -60), {"leg1": 60, "leg2": 60, "leg3": 60}),
    ("delta", "delta", (16, -55), {}),
    ("linear-delta", "linear-delta", (18, -55), {}),
    ("orthoglide", "orthoglide", (24, -50), {}),
    ("tripteron", "tripteron", (24, -55), {}),
    ("3-upu", "3-upu", (18, -60), {}),
    ("quadrupteron", "quadrupteron", (24, -55), {}),
    ("stewart", "stewart", (20, -60), {}),
    ("hexa", "hexa", (20, -60), {}),
    ("tricept", "tricept", (18, -60), {}),
    ("ankle", "ankle", (18, -60), {}),
)


def draw():
    for drawn in DRAWN:
        schematic(*drawn)


class Joint:
    """Where a joint is drawn: mostly at its point; at a radius if the leg rotates about a point."""

    def __init__(self, table, section):
        self.name, self.kind = table["name"], table["type"]
        self.actuated, self.section = table.get("actuated", False), section
        self.at = self.point = np.array(table["point"], float)
        self.axis = np.array(table.get("axis", (0, 0, 0)), float)
        norm = np.linalg.norm(self.axis)
        self.axis = self.axis / norm if norm > 0 else self.axis


def read(name, radii):
    """The legs of a mechanism as lists of joints, the platform's point, and its decomposition."""
    text = (REPOSITORY / "crates/opm-core/mechanisms" / f"{name}.toml").read_text()
    file = tomllib.loads(text)
    found = json.loads(opm("decompose", name, "--format", "json", "--quiet"))
    legs = []
    for leg, split in zip(file["leg"], found["legs"], strict=True):
        lower = set(split["lower"])
        joints = [Joint(t, LOWER if t["name"] in lower else UPPER) for t in leg["joints"]]
        if leg["name"] in radii:
            spread(joints, found, radii[leg["name"]])
        legs.append(joints)
    return legs, np.array(file["platform"]["point"], float), found


def spread(joints, found, radius):
    """Moves the revolutes of spherical sections out of their centre along their axes."""
    spherical = {
        color
        for color, section in ((LOWER, "lower"), (UPPER, "upper"))
        if found[section] is not None and found[section]["subspace"] == "spherical"
    }
    for joint in joints:
        if joint.kind == "revolute" and joint.section in spherical:
            joint.at = joint.point + radius * joint.axis


def link(one, other, steps=24):
    """A link from joint to joint: an arc about the point where both axes meet, or a straight line."""
    a, b = one.at - one.point, other.at - other.point
    if not np.allclose(one.point, other.point) or min(np.linalg.norm(a), np.linalg.norm(b)) == 0:
        return np.array([one.at, other.at])
    shares = np.linspace(0, 1, steps)[:, None]
    way = (1 - shares) * a + shares * b
    way *= np.linalg.norm(a) / np.linalg.norm(way, axis=1, keepdims=True)
    return one.point + way


def schematic(name, picture, view, radii):
    legs, platform, found = read(name, radii)
    joints = [joint for leg in legs for joint in leg]
    points = np.array([j.at for j in joints] + [j.point for j in joints] + [platform])
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.max(high - low)

    figure = plt.figure(figsize=(6.6, 5))
    panel = figure.add_axes((-0.06, -0.02, 1.08, 1.12), projection="3d", computed_zorder=False)
    for leg in legs:
        for one, other in zip(leg, leg[1:]):
            panel.plot(*link(one, other).T, color=FAINT, linewidth=2.2, zorder=2, solid_capstyle="round")
        panel.plot(*np.array([leg[-1].at, platform]).T, color=INK, linewidth=2.2, zorder=2, alpha=0.55)
        base = leg[0].at
        panel.plot(*base, marker="s", color="white", markeredgecolor=FAINT, markersize=13, zorder=1)
    if found["intersection"] is not None:
        imaginary(panel, found, legs, size)
    for joint in joints:
        symbol(panel, joint, 0.085 * size)
    panel.plot(*platform, marker="*", color=INK, markersize=11, zorder=6)

    margin = 0.06 * size
    span = np.maximum(high - low, 0.25 * size) / 2 + margin
    center = (low + high) / 2
    panel.set(xlim=center[0] + span[0] * np.array((-1, 1)), xlabel="x (mm)")
    panel.set(ylim=center[1] + span[1] * np.array((-1, 1)), ylabel="y (mm)")
    panel.set(zlim=center[2] + span[2] * np.array((-1, 1)), zlabel="z (mm)")
    panel.locator_params(nbins=5)
    for axis in (panel.xaxis, panel.yaxis):
        axis.labelpad = 10
    # What is tall stays below the legend.
    tall = span[2] / np.hypot(span[0], span[1])
    panel.set_box_aspect(span, zoom=0.87 * min(1, max(0.6, 0.85 / tall)))
    panel.view_init(*view)
    for axis in (panel.xaxis, panel.yaxis, panel.zaxis):
        axis.pane.set_facecolor("#fafafa")
        axis._axinfo["grid"]["color"] = "#e6e6e6"
    legend(figure, found)
    save(figure, f"gallery-{picture}-joints.png")


def symbol(panel, joint, length):
    """An axis as an arrow, a slider as one with two heads; motors filled."""
    reach = length * joint.axis
    color, width = joint.section, 2.4 if joint.actuated else 1.5
    if joint.kind == "prismatic":
        for side in (-1, 1):
            panel.quiver(*joint.at, *(1.25 * side * reach), color=color, linewidth=width, arrow_length_ratio=0.3, zorder=4)
    elif joint.kind != "spherical":
        panel.quiver(*(joint.at - 0.6 * reach), *(1.6 * reach), color=color, linewidth=width, arrow_length_ratio=0.25, zorder=4)
    marker = {"prismatic": "s", "helical": "D", "spherical": "o"}.get(joint.kind, "o")
    size = 10 if joint.kind == "spherical" else 6.5
    face = color if joint.actuated else "white"
    panel.plot(*joint.at, marker=marker, color=color, markerfacecolor=face, markersize=size, markeredgewidth=1.5, zorder=5)


def imaginary(panel, found, legs, size):
    """A dashed line along the shared motion: its axis, or a slide where each leg is split."""
    shared = found["intersection"]
    along = np.array(shared["axis"])
    cuts = [
        leg for leg, split in zip(legs, found["legs"], strict=True) if split["imaginary"] is not None
    ]
    if shared["kind"] == "rotation":
        point = 1000 * np.array(shared["point"])
        joints = [j.point for leg in legs for j in leg]
        reach = [(p - point) @ along for p in joints]
        ends = [min(reach) - 0.15 * size, max(reach) + 0.15 * size]
        lines = [np.array([point + end * along for end in ends])]
    else:
        lines = []
        for leg in cuts:
            lower, upper = ([j for j in leg if j.section == s] for s in (LOWER, UPPER))
            # A leg that is a whole section has the imaginary joint at its platform.
            ends = [joint.at for joint in (*lower[-1:], *upper[:1])]
            middle = np.mean(ends, axis=0)
            if len(ends) == 2 and np.allclose(*ends):
                middle = middle + (0, 0, 0.05 * size)  # beside the axes that meet there
            lines.append(np.array([middle - 0.14 * size * along, middle + 0.14 * size * along]))
    for line in lines:
        panel.plot(*line.T, color=IMAGINARY, linewidth=2, linestyle=(0, (3, 1.6)), zorder=3)


def legend(figure, found):
    def line(color, **more):
        return Line2D([], [], color=color, **more)

    if found["legs"][0]["solved"] == "whole":
        sections = [(line(LOWER, linewidth=2), found["platform"]["motion"])]
    elif found["upper"] is None:
        sections = [(line(LOWER, linewidth=2), f"one subspace: {found['lower']['subspace']}")]
    else:
        sections = [
            (line(LOWER, linewidth=2), f"lower: {found['lower']['subspace']}"),
            (line(UPPER, linewidth=2), f"upper: {found['upper']['subspace']}"),
        ]
        if found["intersection"] is not None:
            shared = f"imaginary: {found['intersection']['kind']}"
            sections.append((line(IMAGINARY, linewidth=2, linestyle=(0, (3, 1.6))), shared))
    entries = [
        *sections,
        (line(INK, marker="o", linestyle="", markersize=7), "driven"),
        (line(INK, marker="o", linestyle="", markersize=7, markerfacecolor="white"), "passive"),
        (line(INK, marker="*", linestyle="", markersize=10), "platform"),
    ]
    handles, labels = zip(*entries)
    figure.legend(handles, labels, loc="upper left", ncols=2, frameon=False, fontsize=9.5, columnspacing=1.4)
