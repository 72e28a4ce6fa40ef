"""The mechanisms whose models are tested, and what `opm` says of them."""

import csv
import json
import re
import subprocess

from conftest import LINKAGES, REPOSITORY

# Of the linkages that opm ships, Sarrus' has a pose, too.
LOOPS = [name for name in LINKAGES if name != "sarrus"]
SHIPPED = REPOSITORY / "crates/opm-core/mechanisms"
MECHANISMS = sorted(path.stem for path in SHIPPED.glob("*.toml"))
# Joints that no shipped mechanism has, in place of some that one has: its name, what is replaced, and by what.
ARM = re.compile(r'  \{ name = "mu4".*\n.*\n')
UNIVERSAL = (
    '  { name = "u4", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [0, 0, 0], actuated = true, '
    "home = [10, -5], limits = [[-60, 60], [-60, 60]] },\n"
)
PITCH = re.compile("pitch = 20 ")
VARIED = {
    "universal": ("double-spherical-5dof", ARM, UNIVERSAL),
    "left-handed": ("translational-helical-3dof-joints", PITCH, "pitch = -35, home = 20 "),
    "large-pitch": ("translational-helical-3dof-joints", PITCH, "pitch = 1500, home = 20 "),
}


def run(opm, *arguments):
    return subprocess.run([opm, *arguments], capture_output=True, text=True, check=True).stdout


def answer(opm, *arguments):
    return json.loads(run(opm, *arguments, "--format", "json", "--quiet"))


def table(text):
    """The rows of a table, numbers where they are numbers; rows out of reach are left out."""
    rows = [row for row in csv.DictReader(text.splitlines()) if all(row.values())]
    text = ("branch", "mode")
    return [{k: v if k in text else float(v) for k, v in row.items()} for row in rows]


class Mechanism:
    """A mechanism by name, shipped or varied, and its motions."""

    def __init__(self, opm, folder, name):
        self.opm, self.folder, self.name = opm, folder, name
        self.varied = name in VARIED
        if self.varied:
            base, old, new = VARIED[name]
            text, count = old.subn(new, (SHIPPED / f"{base}.toml").read_text())
            assert count == 1
            self.name = folder / f"{name}.toml"
            self.name.write_text(text)
        self.answer = answer(opm, "decompose", self.name)
        self.is_linkage = name in LOOPS
        # How large it is, metres.
        points = [joint["point"] for joint in self.answer["joints"]] + [self.answer["reference_point"], [0, 0, 0]]
        self.size = max(max(values) - min(values) for values in zip(*points, strict=True))

    def motion_file(self, seconds, rate, coordinates):
        """A file of a motion, of which `coordinates` gives (amplitude, frequency, phase, offset)."""
        lines = ["format = 1", 'name = "m"', 'units = { length = "m", angle = "rad" }']
        lines += [f"duration = {seconds}", f"rate = {rate}", "[coordinates]"]
        for name, (amplitude, frequency, phase, offset) in coordinates.items():
            lines.append(
                f"{name} = {{ amplitude = {amplitude}, frequency = {frequency}, phase = {phase}, offset = {offset} }}"
            )
        path = self.folder / "motion.toml"
        path.write_text("\n".join(lines) + "\n")
        return path

    def motion(self, seconds, rate, coordinates, mode="home"):
        """The rows of a motion."""
        path = self.motion_file(seconds, rate, coordinates)
        arguments = ["--motion", path, "--mode", mode, "--quiet", "-o", "-"]
        return table(run(self.opm, "trajectory", self.name, *arguments))

    def poses(self, generator, count, modes):
        """Rows of joint values: poses around home in some of these modes, or positions of a linkage."""
        if self.is_linkage:
            return table(run(self.opm, "linkage", self.name, "--sweep", "--count", str(count)))
        rows = []
        for mode in modes:
            moves = {
                name: (span, generator.uniform(0.1, 0.4), generator.uniform(0, 6.3), home)
                for name, home, span in self.spans(angle=0.3, length=0.05)
            }
            rows += self.motion(count / len(modes), 2, moves, mode)
        return rows

    def spans(self, angle, length):
        """How far each task coordinate is moved from home."""
        for coordinate in self.answer["task_coordinates"]:
            span = angle if coordinate["unit"] == "rad" else length * self.size
            yield coordinate["name"], coordinate["home"], span

    def at_rest(self, seconds):
        """From home and back, at rest at both ends; every other coordinate goes there and back twice."""
        return {
            name: (span, (1 + number % 2) / seconds, -1.5707963267948966, home + span)
            for number, (name, home, span) in enumerate(self.spans(angle=0.05, length=0.01))
        }
