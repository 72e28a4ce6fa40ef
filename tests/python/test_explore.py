"""The page of `opm explore`, in a real browser, opened from a file without a network."""

import gzip
import itertools
import json
import math
import re
import shlex
import shutil
import subprocess
import time
from pathlib import Path

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome"])), None)
if CHROMIUM is None:
    pytest.skip("no Chromium here: the explorer's page was not tested", allow_module_level=True)
playwright = pytest.importorskip("playwright.sync_api")

PLANO = "plano-spherical-5dof"
# Where there is no graphics card, the processor draws.
DRAWING = ["--enable-unsafe-swiftshader"]
QUIET = ["--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"]
REPOSITORY = Path(__file__).parents[2]
STORED = REPOSITORY / "crates/opm-export/page/explorer.html.gz"
# What `npm ci` in web/ gets: what the page is built with, and the checker of accessibility.
PACKAGES = REPOSITORY / "web/node_modules"
AXE = PACKAGES / "axe-core/axe.min.js"
# Fitting a grid takes seconds where others compute too.
PATIENCE = 180_000


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as program:
        started = program.chromium.launch(executable_path=CHROMIUM, args=DRAWING + QUIET)
        yield started
        started.close()


# The middle time of a frame in which nothing is drawn: what this browser can do at best.
STILL = """async () => {
    const times = [];
    let last = await new Promise(requestAnimationFrame);
    for (let i = 0; i < 30; i++) {
        const now = await new Promise(requestAnimationFrame);
        times.push(now - last);
        last = now;
    }
    return times.sort((a, b) => a - b)[15];
}"""


class Explorer:
    """One page, and what it did that a page must not do."""

    def __init__(self, browser, file, address="", **options):
        self.file = file.as_uri()
        options.setdefault("viewport", {"width": 1400, "height": 900})
        self.context = browser.new_context(offline=True, **options)
        self.page = self.context.new_page()
        self.page.set_default_timeout(PATIENCE)
        self.wrong = []
        self.page.on("console", self.heard)
        self.page.on("pageerror", lambda error: self.wrong.append(str(error)))
        self.page.on("request", self.note)
        self.page.goto(self.file + address)
        self.ready()

    def heard(self, message):
        # Without a graphics card, Chromium itself warns of reading what it has drawn.
        if message.type == "error":
            self.wrong.append(message.text)

    def note(self, request):
        # Its workers come from the page itself.
        if not request.url.startswith((self.file, "blob:")):
            self.wrong.append(request.url)

    def ready(self):
        self.page.wait_for_selector("body[data-ready=true]")

    def fill(self, **fields):
        """Enters values into fields, as somebody who types does."""
        for name, value in fields.items():
            self.enter(name.replace("_", "-"), value)

    def enter(self, name, value):
        self.page.locator(f"[id='{name}']").fill(str(value))
        self.page.keyboard.press("Tab")
        self.ready()

    def choose(self, name, value):
        self.page.select_option(f"#{name}", value)
        self.ready()

    def text(self, name):
        return self.page.locator(f"[id='{name}']").inner_text()

    def value(self, name):
        return self.page.locator(f"[id='{name}']").input_value()

    def count(self):
        return self.text("slice-count")

    def bodies(self):
        """The drawing, as bytes."""
        with self.page.expect_download() as download:
            self.page.select_option("#save", "picture")
        return download.value.path().read_bytes()

    def close(self):
        self.context.close()
        assert self.wrong == []


@pytest.fixture(scope="module")
def file(opm, tmp_path_factory):
    """The page of the plano-spherical mechanism."""
    path = tmp_path_factory.mktemp("explore") / "robot.html"
    done = subprocess.run([opm, "explore", PLANO, "--quiet", "-o", path], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return path


@pytest.fixture
def explore(browser, file):
    """Opens the page; at the end it must have asked for nothing and have written nothing to the console."""
    opened = []

    def start(address="", **options):
        opened.append(Explorer(browser, file, address, **options))
        return opened[-1]

    yield start
    for explorer in opened:
        explorer.close()


def until(page, expression, arg=None, seconds=30):
    """Waits until an expression holds. Playwright's own way evaluates text in the page, which the page's policy forbids."""
    end = time.monotonic() + seconds
    while not page.evaluate(expression, arg):
        assert time.monotonic() < end, expression
        page.wait_for_timeout(50)


def expected(answer):
    return f"{answer['reachable']} of {answer['poses']}"


def seen(explorer, path, title):
    """Keeps a picture of the page, for whoever wants to look at it."""
    explorer.page.screenshot(path=path)
    print(f"{title}: {path}")


def test_the_page_runs_its_own_scripts_alone(explore):
    """A script that a mechanism file smuggled in would neither run nor reach a network; the page itself breaks no rule."""
    explorer = explore()
    assert explorer.wrong == []
    explorer.page.evaluate("""() => {
        const script = document.createElement("script");
        script.textContent = "window.smuggled = true";
        document.body.append(script);
        const image = new Image();
        image.src = "https://example.org/told.png";
    }""")
    explorer.page.wait_for_timeout(500)
    assert explorer.page.evaluate("window.smuggled") is None
    said = [said for said in explorer.wrong if said != "https://example.org/told.png"]
    assert len(said) == 2 and all("Content Security Policy" in one for one in said)
    explorer.wrong.clear()


def test_slices_have_the_counts_of_the_command_line(explore, workspace):
    explorer = explore()
    explorer.fill(slice_xmin=-150, slice_xmax=150, slice_ymin=-150, slice_ymax=150, slice_nx=61, slice_ny=61)
    grid = ["--grid", "x=-150mm:150mm:61", "--grid", "y=-150mm:150mm:61"]
    assert explorer.count() == expected(workspace(PLANO, *grid))

    explorer.fill(pose_xi=15, pose_zeta=-7.5)
    grid += ["--grid", "xi=15deg", "--grid", "zeta=-7.5deg"]
    assert explorer.count() == expected(workspace(PLANO, *grid))

    # Another plane, in another mode.
    explorer.choose("slice-y", "xi")
    explorer.fill(slice_xmin=-200, slice_xmax=200, slice_ymin=-50, slice_ymax=60, slice_nx=83, slice_ny=47, pose_y=12.5)
    mode = "-+ ++ +- -"
    explorer.choose("mode", mode)
    grid = ["--grid", "x=-200mm:200mm:83", "--grid", "xi=-50deg:60deg:47", "--grid", "y=12.5mm", "--grid", "zeta=-7.5deg"]
    assert explorer.count() == expected(workspace(PLANO, *grid, "--mode", mode))


def test_the_whole_workspace_has_the_count_of_the_command_line(explore, workspace):
    explorer = explore()
    answer = workspace(PLANO)
    assert explorer.text("whole-count") == f"{answer['reachable']:,} of {answer['poses']:,}"


def test_a_dimension_changes_mechanism_and_workspace_and_is_undone(explore, workspace):
    explorer = explore()
    explorer.fill(slice_xmin=-150, slice_xmax=150, slice_ymin=-150, slice_ymax=150)
    grid = ["--grid", "x=-150mm:150mm:201", "--grid", "y=-150mm:150mm:201"]
    before, drawn, s1 = explorer.count(), explorer.bodies(), explorer.value("joint-S1")
    assert before == expected(workspace(PLANO, *grid))
    assert explorer.page.locator("#undo").is_disabled()

    explorer.enter("param-leg1.h", 140)
    assert explorer.count() == expected(workspace(PLANO, *grid, "--set", "leg1.h=140mm"))
    assert explorer.count() != before and explorer.bodies() != drawn
    assert explorer.value("joint-S1") != s1

    # Its slider, moved by the keyboard, does the same.
    slider = explorer.page.locator("[aria-label='h, slider']").first
    slider.focus()
    for _ in range(5):
        explorer.page.keyboard.press("ArrowRight")
    explorer.ready()
    moved = explorer.value("param-leg1.h")
    assert moved != "140"
    assert explorer.count() == expected(workspace(PLANO, *grid, "--set", f"leg1.h={moved}mm"))

    while explorer.page.locator("#undo").is_enabled():
        explorer.page.click("#undo")
        explorer.ready()
    assert (explorer.count(), explorer.value("joint-S1")) == (before, s1)
    assert explorer.value("param-leg1.h") == "120"
    explorer.page.click("#redo")
    explorer.ready()
    assert explorer.value("param-leg1.h") == "140"


def test_a_change_that_leaves_nothing_to_compute_says_why(explore):
    explorer = explore()
    before = explorer.count()
    explorer.enter("param-leg4.b1", 1)
    assert "leg4" in explorer.text("problems")
    assert explorer.count() == before
    explorer.page.click("#problems button")
    explorer.ready()
    assert explorer.page.locator("#problems").is_hidden()
    assert explorer.value("param-leg4.b1") == "100"


def test_a_pose_out_of_reach_keeps_the_last_good_one(explore, opm):
    explorer = explore()
    explorer.fill(pose_x=10, pose_xi=15)
    # S1 = 168.806 mm is in the docs of the project.
    assert float(explorer.value("joint-S1")) == pytest.approx(168.806, abs=1e-3)
    drawn = explorer.bodies()
    explorer.fill(pose_y=900)
    status = explorer.text("status")
    command = [opm, "ik", PLANO, "--pose", "x=10mm,y=900mm,xi=15deg", "--format", "text"]
    told = subprocess.run(command, capture_output=True, text=True).stdout
    [reach] = re.findall(r"leg4: (.*)", told)
    assert f"leg4, {reach}" in status
    assert explorer.bodies() == drawn
    assert float(explorer.value("joint-S1")) == pytest.approx(168.806, abs=1e-3)


def test_modes_and_actuated_joints(explore, opm):
    explorer = explore()
    explorer.fill(pose_x=10, pose_xi=15)
    command = [opm, "ik", PLANO, "--pose", "x=10mm,xi=15deg", "--all-modes", "--format", "json"]
    solutions = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["solutions"]
    options = explorer.page.locator("#mode option")
    values = [option.get_attribute("value") for option in options.all()]
    assert set(values) >= {solution["mode"] for solution in solutions}
    other = next(s for s in solutions if s["mode"] != "++ ++ ++ +" and s["within_limits"])
    explorer.choose("mode", other["mode"])
    assert float(explorer.value("joint-S1")) == pytest.approx(1000 * other["joints"]["S1"], abs=1e-3)

    # A slider's motor moves the platform, in the same mode, to a pose that has this value.
    explorer.enter("joint-S1", 150)
    assert float(explorer.value("joint-S1")) == pytest.approx(150, abs=1e-6)
    names = ["x", "y", "zeta", "xi", "psi"]
    units = ["mm", "mm", "deg", "deg", "deg"]
    pose = ",".join(f"{name}={explorer.value('pose-' + name)}{unit}" for name, unit in zip(names, units))
    command = [opm, "ik", PLANO, "--pose", pose, "--mode", explorer.value("mode"), "--format", "json"]
    solved = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["solutions"]
    assert solved[0]["joints"]["S1"] == pytest.approx(0.150, abs=1e-6)


def test_an_actuated_joint_is_dragged(explore):
    """Its slider goes over the range of its limits, and is where the joint is."""
    explorer = explore("#pose.x=10&pose.xi=15")
    slider = explorer.page.get_by_label("S1, slider", exact=True)
    ends = [float(slider.get_attribute(end)) for end in ("min", "max")]
    assert ends == [-300, 300]
    at = lambda: float(slider.input_value())  # noqa: E731
    pose = lambda: [explorer.value(f"pose-{name}") for name in ("x", "y", "zeta", "xi", "psi")]  # noqa: E731
    before, start = at(), pose()
    assert before == pytest.approx(float(explorer.value("joint-S1")), abs=1e-3)
    steps = explorer.page.evaluate("history.length")
    # While it is held, no step is added to what the browser goes back to.
    slider.evaluate("""(slider) => {
        for (const more of [5, 10, 15]) {
            slider.value = String(Number(slider.value) - 5);
            slider.dispatchEvent(new Event("input", { bubbles: true }));
        }
    }""")
    explorer.ready()
    assert explorer.page.evaluate("history.length") == steps
    slider.dispatch_event("change")
    explorer.ready()
    assert explorer.page.evaluate("history.length") == steps + 1
    assert float(explorer.value("joint-S1")) == pytest.approx(before - 15, abs=0.6)
    assert at() == pytest.approx(float(explorer.value("joint-S1")), abs=1e-3) and pose() != start
    # Beyond what any pose has, it says so, and stays.
    slider.evaluate("(slider) => { slider.value = '-300'; slider.dispatchEvent(new Event('change', { bubbles: true })); }")
    explorer.ready()
    assert "No pose of the platform has S1 = -300" in explorer.text("status")
    assert at() == pytest.approx(float(explorer.value("joint-S1")), abs=1e-3)


def test_a_link_shares_what_is_shown(explore):
    explorer = explore()
    explorer.enter("param-leg2.a1", 210)
    explorer.fill(pose_x=20, pose_xi=10, slice_nx=51)
    explorer.choose("slice-y", "psi")
    address = explorer.page.evaluate("location.hash")
    fields = ["param-leg2.a1", "pose-x", "pose-xi", "slice-nx", "slice-y", "slice-ymin", "joint-S2", "mode"]
    shown = [explorer.value(name) for name in fields]
    other = explore(address)
    assert [other.value(name) for name in fields] == shown
    assert other.count() == explorer.count()

    # Back, step by step.
    explorer.page.go_back()
    until(explorer.page, "document.querySelector('#slice-y').value === 'y'")
    explorer.ready()
    explorer.page.go_forward()
    until(explorer.page, "document.querySelector('#slice-y').value === 'psi'")
    explorer.ready()
    assert explorer.count() == other.count()


# What is measured on fitted grids.
MEASURED = ["whole-count", "whole-share", "kind-count", "kind-measure", "body-count"]
RANGE = ["slice-xmin", "slice-xmax", "slice-ymin", "slice-ymax"]


def measured(explorer):
    return [explorer.text(name) for name in MEASURED] + [explorer.value(name) for name in RANGE]


def test_a_link_measures_what_its_sender_saw(explore, workspace):
    explorer = explore("#example=planar-3rpr&kind=reachable&body=any&set.S1.limits=5:52.5&set.S2.limits=5:52.5")
    before = measured(explorer)
    # As a slider that a pointer still holds.
    explorer.page.evaluate("""() => {
        const field = document.getElementById("param-S3.limits.max");
        for (const value of [40, 52.5]) {
            field.value = String(value);
            field.dispatchEvent(new Event("input", { bubbles: true }));
        }
    }""")
    until(explorer.page, "document.body.dataset.ready === 'true'")
    after = measured(explorer)
    changes = [part for leg in (1, 2, 3) for part in ("--set", f"S{leg}.limits=5mm:52.5mm")]
    answer = workspace("planar-3rpr", *changes)
    assert explorer.text("whole-count") == f"{answer['reachable']:,} of {answer['poses']:,}"
    explorer.page.evaluate("navigator.clipboard.writeText = async () => {}")
    explorer.page.click("#share")
    until(explorer.page, "location.hash.includes('S3.limits')")
    other = explore(explorer.page.evaluate("location.hash"))
    assert measured(other) == after != before

    # The grids of a mode are those of this mode.
    mode = "+ + + +"
    for page, address in [(explorer, ""), (other, f"&mode={mode}".replace("+", "%2B"))]:
        address = f"example=translational-planar-4dof&kind=reachable&body=any{address}"
        page.page.evaluate("(hash) => { location.hash = hash; }", address)
        until(page.page, "document.querySelector('#title').textContent.startsWith('translational')")
        page.ready()
    assert explorer.value("mode") != other.value("mode") == mode
    explorer.choose("mode", mode)
    answer = workspace("translational-planar-4dof", "--mode", mode)
    assert explorer.text("whole-count") == f"{answer['reachable']:,} of {answer['poses']:,}"
    assert measured(other) == measured(explorer)


def test_what_a_link_asks_for_and_is_not_there_is_told(explore):
    explorer = explore("#mode=zzz")
    count = explorer.text("whole-count")
    assert "mode=zzz" in explorer.text("problems") and explorer.value("mode") == "++ ++ ++ +"
    assert re.fullmatch(r"[\d,]+ of [\d,]+", count)
    explorer.enter("pose-x", 12)
    assert "mode=zzz" in explorer.text("problems")
    for address, told in [
        ("example=nosuch&pose.x=5", "example=nosuch: opm ships no mechanism of this name. The page shows its own"),
        ("name=a.toml&file=damaged", "file=…: the mechanism in the link is damaged"),
        ("example=bennett-plano-spherical-6r", "bennett-plano-spherical-6r.toml:"),
        ("motion=nosuch", "motion=nosuch"),
        ("pose.w=1&pose.x=far", "pose.w: this mechanism has no such coordinate"),
        ("slice.x=w&kind=round&slice.nx=-3&colour=red", "slice.x=w: this mechanism has no such coordinate"),
    ]:
        explorer.page.evaluate("(hash) => { location.hash = hash; }", address)
        until(explorer.page, "(told) => document.querySelector('#problems').textContent.includes(told)", arg=told)
        explorer.ready()
        assert (explorer.text("title"), explorer.text("whole-count"), explorer.value("motion")) == (PLANO, count, "")
    problems = explorer.text("problems")
    assert "kind=round" in problems and "slice.nx=-3" in problems and "colour: not known" in problems
    explorer.page.select_option("#examples", PLANO)
    explorer.ready()
    assert explorer.page.locator("#problems").is_hidden()


def test_a_problem_is_told_while_there_is_one(explore):
    explorer = explore()
    before = explorer.count()
    explorer.fill(slice_xmin=500, slice_xmax=270)
    assert "slice along x: 201 values from 500 to 270 mm, expected the smaller end first" in explorer.text("problems")
    assert explorer.count() == "–"
    explorer.fill(slice_xmin="", slice_xmax="")
    assert explorer.page.locator("#problems").is_hidden()
    assert explorer.count() == before

    # A joint that cannot have a value has the one that is shown.
    s1 = explorer.value("joint-S1")
    explorer.page.locator("#joint-S1").fill("5000")
    explorer.page.keyboard.press("Enter")
    explorer.ready()
    assert "No pose of the platform has S1 = 5000" in explorer.text("status")
    assert explorer.value("joint-S1") == s1


def test_saved_tables_are_read_by_the_command(explore, opm):
    explorer = explore("#slice.x=xi&slice.y=x&slice.nx=7&slice.ny=5&pose.y=12.5&pose.zeta=-8&pose.xi=15&slice.colour=S1")

    def saved(what):
        with explorer.page.expect_download() as download:
            explorer.page.select_option("#save", what)
        return download.value.path().read_text()

    def solved(table):
        done = subprocess.run([opm, "ik", PLANO, "--poses", "-"], input=table, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return [dict(zip(done.stdout.split("\n")[0].split(","), row.split(","))) for row in done.stdout.splitlines()[1:]]

    def columns(table):
        head, *rows = table.splitlines()
        return [dict(zip(head.split(","), row.split(","))) for row in rows]

    slice_table, count = saved("slice-csv"), int(explorer.count().split()[0])
    explorer.fill(pose_y=900)
    assert "Out of reach" in explorer.text("status")
    # The pose that is shown, and not the one that is out of reach.
    table = saved("pose")
    [row], [found] = columns(table), solved(table)
    assert (row["y [mm]"], row["xi [deg]"], row["mode"]) == ("12.5", "15", "++ ++ ++ +")
    assert float(row["S1 [mm]"]) == pytest.approx(1000 * float(found["S1"]), abs=1e-6)
    assert float(row["theta11 [deg]"]) == pytest.approx(57.29577951308232 * float(found["theta11"]), abs=1e-6)

    rows, found = columns(slice_table), solved(slice_table)
    assert len(rows) == len(found) == count > 5
    assert all(row["y [mm]"] == "12.5" and row["zeta [deg]"] == "-8" for row in rows)
    for row, pose in zip(rows, found):
        assert pose["within_limits"] == "1"
        assert float(row["S1 [mm]"]) == pytest.approx(1000 * float(pose["S1"]), abs=1e-3)

    # Of a five-bar, the angle of the platform follows.
    explorer.page.select_option("#examples", "five-bar")
    explorer.ready()
    [row] = columns(saved("pose"))
    assert float(row["theta [deg]"]) == pytest.approx(float(explorer.text("dependent-theta")), abs=1e-3)


def test_a_workspace_without_bounds_is_not_shown_as_measured(explore, opm):
    name = "translational-helical-3dof"
    explorer = explore(f"#example={name}&kind=reachable&body=any")
    assert explorer.text("whole-beyond") == explorer.text("kind-beyond") == explorer.text("body-beyond") == ""
    changes = "".join(f"&set.leg{leg}.limits.S=" for leg in (1, 2, 3))
    explorer.page.evaluate("(more) => { location.hash += more; }", changes)
    until(explorer.page, "document.querySelector('#whole-beyond').textContent !== ''")
    explorer.ready()
    done = subprocess.run([opm, "workspace", name, "--set", "limits.S=none"], capture_output=True, text=True)
    told = re.findall(r"continues beyond this grid along (\w+)", done.stderr)
    assert told == ["x", "y", "phi"]
    expected = "continues beyond this grid along x, y and phi"
    assert all(expected in explorer.text(f"{what}-beyond") for what in ("whole", "kind", "body"))


def test_a_link_with_a_wrong_change_says_so_and_shows_the_file(explore):
    explorer = explore("#set.leg1.h=1&set.leg9.h=3&pose.x=10")
    assert "`leg9.h` is not a parameter" in explorer.text("problems")
    assert (explorer.value("param-leg1.h"), explorer.value("pose-x")) == ("120", "10")
    assert re.fullmatch(r"\d+ of 40401", explorer.count())


def ink(explorer, canvas):
    """How many pixels of a canvas are drawn, and how many have the colour of the marks."""
    return explorer.page.evaluate("""async id => {
        await new Promise(requestAnimationFrame);
        await new Promise(requestAnimationFrame);
        const canvas = document.getElementById(id);
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        let [drawn, marked] = [0, 0];
        for (let i = 0; i < data.length; i += 4) {
            if (data[i + 3] > 100) drawn++;
            if (data[i + 3] > 200 && data[i] > 150 && data[i + 1] < 80 && data[i + 2] < 80) marked++;
        }
        return [drawn, marked];
    }""", canvas)


def test_joints_are_named_and_marked_in_the_view(explore):
    explorer = explore()
    named, marked = ink(explorer, "marks")
    assert marked == 0
    row = explorer.page.locator("#joints tr:has(#joint-phi21)")
    row.hover()
    assert row.get_attribute("class") == "pointed"
    assert ink(explorer, "marks")[1] > 50
    # Both ways: a joint that is pointed at in the view marks its row.
    explorer.page.mouse.move(5, 5)
    assert ink(explorer, "marks")[1] == 0
    assert explorer.page.locator("#joints tr.pointed").count() == 0
    # Axes and scale stay without the names.
    explorer.page.uncheck("#names")
    assert 0 < ink(explorer, "marks")[0] < named


def test_slices_have_equal_scales_and_a_bar_of_colours(explore, tmp_path):
    explorer = explore()
    explorer.choose("slice-colour", "lti")
    with explorer.page.expect_download() as download:
        explorer.page.select_option("#save", "slice-svg")
    svg = download.value.path().read_text()
    [(_, _, across, upwards), (_, _, bar, high)] = re.findall(r'<image x="([^"]*)" y="([^"]*)" width="([^"]*)" height="([^"]*)"', svg)
    xmin, xmax, ymin, ymax = (float(explorer.value(f"slice-{end}")) for end in ("xmin", "xmax", "ymin", "ymax"))
    # A cell for each of the 201 values.
    assert float(across) / float(upwards) == pytest.approx((xmax - xmin) / (ymax - ymin), rel=0.01)
    assert float(high) == float(upwards) and float(bar) < 20
    assert ">lti</text>" in svg and ">0.8</text>" in svg
    with explorer.page.expect_download() as download:
        explorer.page.select_option("#save", "slice-csv")
    head, first, *_ = download.value.path().read_text().splitlines()
    assert head.endswith(",lti") and 0 < float(first.rsplit(",", 1)[1]) < 1
    explorer.choose("slice-colour", "clearance")
    assert "slice.colour=clearance" in explorer.page.evaluate("location.hash")
    # An angle and a length have no scale in common.
    explorer.choose("slice-y", "zeta")
    assert explorer.page.locator("#problems").is_hidden()


def test_the_slice_of_a_phone_is_above_the_joints(explore):
    explorer = explore(viewport={"width": 390, "height": 844})
    places = {name: explorer.page.locator(f"#{name}").bounding_box()["y"] for name in ("pose", "slice-canvas", "joints")}
    assert places["pose"] < places["slice-canvas"] < places["joints"]
    explorer.page.set_viewport_size({"width": 1400, "height": 900})
    assert explorer.page.locator("#slice-canvas").bounding_box()["x"] > 900


def test_what_is_printed_is_the_picture_and_no_controls(explore):
    explorer = explore()
    assert explorer.page.locator("#printed").is_hidden()
    explorer.page.evaluate("dispatchEvent(new Event('beforeprint'))")
    explorer.page.emulate_media(media="print")
    drawn = explorer.page.evaluate("""() => {
        const canvas = document.querySelector("#printed canvas");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        return new Set(data.filter((_, i) => i % 4 === 0)).size;
    }""")
    assert drawn > 50
    for control in ("#save", "#marks", "#fit", "#home", "#slice-xmin", "#kind", "#clearance", "#pose input[type=range] >> nth=0"):
        assert explorer.page.locator(control).is_hidden(), control
    for shown in ("#printed canvas", "#pose-x", "#joint-S1", "#slice-canvas", "#slice-count", "#nearest"):
        assert explorer.page.locator(shown).is_visible(), shown


def test_a_click_into_the_slice_moves_the_platform(explore):
    explorer = explore()
    box = explorer.page.locator("#slice-canvas").bounding_box()
    explorer.page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"])
    explorer.ready()
    assert float(explorer.value("pose-x")) > 1 and float(explorer.value("pose-y")) > 1
    assert "pose.x" in explorer.page.evaluate("location.hash")
    x = float(explorer.value("pose-x"))
    explorer.page.locator("#slice-canvas").focus()
    explorer.page.keyboard.press("ArrowLeft")
    explorer.ready()
    step = (float(explorer.value("slice-xmax")) - float(explorer.value("slice-xmin"))) / 200
    assert float(explorer.value("pose-x")) == pytest.approx(x - step, abs=1e-6)


def test_files_are_opened_and_saved(explore, tmp_path, opm, workspace):
    explorer = explore()
    explorer.enter("param-leg1.h", 133)
    with explorer.page.expect_download() as download:
        explorer.page.select_option("#save", "mechanism")
    saved = tmp_path / "saved.toml"
    download.value.save_as(saved)
    grid = ["--grid", "x=-150mm:150mm:31", "--grid", "y=-150mm:150mm:31"]
    assert workspace(saved, *grid)["reachable"] == workspace(PLANO, *grid, "--set", "leg1.h=133mm")["reachable"]

    explorer.page.set_input_files("#file", saved)
    until(explorer.page, "document.getElementById('param-leg1.h').value === '133'")
    explorer.ready()
    assert explorer.page.locator("#undo").is_disabled()

    # A broken file is told as on the command line, and the mechanism stays.
    broken = tmp_path / "broken.toml"
    broken.write_text(re.sub("alpha = .*", 'alpha = "thirty"', saved.read_text(), count=1))
    told = subprocess.run([opm, "decompose", broken], capture_output=True, text=True)
    assert told.returncode == 1
    [place] = re.findall(r"broken\.toml(:\d+:\d+: .*)", told.stderr)
    explorer.page.set_input_files("#file", broken)
    explorer.page.wait_for_selector("#problems:not([hidden])")
    explorer.ready()
    assert f"broken.toml{place}" in explorer.text("problems")
    assert (explorer.text("title"), explorer.value("param-leg1.h")) == (PLANO, "133")
    explorer.page.click("#problems button")
    assert explorer.page.locator("#problems").is_hidden()

    with explorer.page.expect_download() as download:
        explorer.page.select_option("#save", "slice-csv")
    lines = download.value.path().read_text().splitlines()
    assert lines[0] == "x [mm],y [mm],zeta [deg],xi [deg],psi [deg]"
    assert len(lines) - 1 == int(explorer.count().split()[0])


def test_every_shipped_mechanism_opens(explore, opm):
    listed = subprocess.run([opm, "examples", "--format", "json"], capture_output=True, text=True, check=True).stdout
    names = [example["name"] for example in json.loads(listed)["examples"]]
    explorer = explore()
    for name in names:
        explorer.page.select_option("#examples", name)
        explorer.ready()
        if name.startswith("bennett"):
            # One loop, moved by one joint: it has no pose.
            assert explorer.page.locator("#problems").is_visible()
            continue
        assert explorer.page.locator("#problems").is_hidden(), (name, explorer.text("problems"))
        assert explorer.text("title") == name
        assert re.fullmatch(r"\d+ of \d+", explorer.count()), name
        assert "In reach" in explorer.text("status"), name


def test_the_body_follows_pose_and_dimensions(explore, workspace):
    explorer = explore()
    before = explorer.bodies()
    explorer.page.click("#body-show")
    explorer.ready()
    count = explorer.text("body-count")
    assert re.fullmatch(r"\d+ of 226981 points, from 226,981 poses", count)
    assert explorer.bodies() != before
    assert explorer.text("body-note").startswith("x and y in the base frame; zeta (deg) upwards")
    explorer.enter("param-leg1.h", 140)
    assert explorer.text("body-count") != count
    address = explorer.page.evaluate("location.hash")
    other = explore(address)
    assert other.text("body-count") == explorer.text("body-count")

    # Of three coordinates with no others, it is the whole workspace.
    explorer.page.select_option("#examples", "translational-helical-3dof")
    explorer.ready()
    explorer.page.click("#body-show")
    explorer.choose("body-others", "any")
    answer = workspace("translational-helical-3dof")
    poses = answer["poses"]
    assert explorer.text("body-count") == f"{answer['reachable']} of {poses} points, from {poses:,} poses"


@pytest.mark.parametrize("kind", ["constant-orientation", "orientation", "reachable", "dexterous", "imaginary", "upper"])
def test_kinds_of_workspace_have_the_counts_of_the_command_line(explore, workspace, kind):
    explorer = explore("#pose.x=20&pose.xi=15")
    explorer.choose("kind", kind)
    if kind in ("reachable", "dexterous"):
        explorer.enter("kind-turn", 12.5)
    options = shlex.split(explorer.page.locator("#kind-command").text_content())
    assert options[:2] == ["--kind", kind]
    answer = workspace(PLANO, *options)
    [members, points] = re.match(r"([\d,]+) of ([\d,]+) ", explorer.text("kind-count")).groups()
    counted = next(answer[key] for key in ("reachable", "members", "dexterous", "closing") if key in answer)
    assert int(members.replace(",", "")) == counted > 0
    assert int(points.replace(",", "")) >= counted


def test_a_motion_is_played_and_its_violations_are_those_of_the_command_line(explore, opm, tmp_path):
    explorer = explore()
    explorer.choose("motion", "plano-spherical-sinusoids")
    assert "follows all 1001 samples" in explorer.text("motion-summary")
    slider = explorer.page.locator("#time")
    slider.focus()
    slider.fill("2.5")
    explorer.ready()
    # At half of the period of 5 s x is 2 + 20 sin(180 + 265 deg), and y is -31 + 18 sin(270 + 85 deg).
    x = 2 + 20 * math.sin(math.radians(85))
    assert float(explorer.value("pose-x")) == pytest.approx(x, abs=1e-4)
    assert float(explorer.value("pose-y")) == pytest.approx(-31 - 18 * math.sin(math.radians(5)), abs=1e-4)
    explorer.page.click("#play")
    until(explorer.page, "document.querySelector('#time').valueAsNumber > 2.8")
    explorer.page.click("#play")
    explorer.ready()
    assert abs(float(explorer.value("pose-x")) - x) > 0.5

    table = tmp_path / "away.csv"
    table.write_text("t,y [mm],xi [deg]\n0,0,0\n2,250,20\n4,-280,0\n")
    explorer.page.set_input_files("#file", table)
    explorer.page.wait_for_selector("#violations li")
    explorer.ready()
    command = [opm, "trajectory", PLANO, "--motion", table, "--format", "json", "--quiet"]
    told = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    count = told["violation_count"]
    assert f"{count} violation" in explorer.text("motion-summary")
    assert f"{told['valid']} of {told['samples']} samples" in explorer.text("motion-summary")
    assert explorer.page.locator("#violations button").count() == min(count, 20)
    # The first one is where the list says, and the platform goes there.
    explorer.page.locator("#violations button").first.click()
    explorer.ready()
    first = min(violation["start"] for violation in told["violations"])
    assert float(slider.input_value()) == pytest.approx(first, abs=1e-3)

    # A broken table is told with line and column.
    table.write_text("t,y\n0,zero\n1,0\n")
    told = subprocess.run([opm, "trajectory", PLANO, "--motion", table], capture_output=True, text=True).stderr
    explorer.page.set_input_files("#file", table)
    explorer.page.wait_for_selector("#problems:not([hidden])")
    [place] = re.findall(r"away\.csv(:\d+:\d+): ", told)
    assert f"away.csv{place}" in explorer.text("problems")
    # Without the motion, nothing is wrong any more.
    explorer.choose("motion", "")
    assert explorer.page.locator("#problems").is_hidden()

    # A wrong mode of the motion is no mode of the page.
    explorer.choose("mode", "-+ ++ +- -")
    wrong = tmp_path / "mode.toml"
    wrong.write_text('format = 1\nname = "a"\nmode = "zzz"\nduration = 1\n\n[coordinates]\nx = 0\n')
    explorer.page.set_input_files("#file", wrong)
    explorer.page.wait_for_selector("#problems:not([hidden])")
    explorer.ready()
    assert "mode.toml:3:" in explorer.text("problems") and "zzz" in explorer.text("problems")
    assert explorer.value("mode") == "-+ ++ +- -"


def test_a_link_has_the_motion(explore, tmp_path):
    explorer = explore()
    explorer.choose("motion", "plano-spherical-sinusoids")
    shipped = explorer.page.evaluate("location.hash")
    assert "motion=plano-spherical-sinusoids" in shipped and "motion.file" not in shipped
    table = tmp_path / "away.csv"
    table.write_text("t,y [mm]\n0,0\n2,20\n")
    explorer.page.set_input_files("#file", table)
    until(explorer.page, "document.querySelector('#motion').value === 'away.csv'")
    explorer.ready()
    told = explorer.text("motion-summary")
    assert "follows all 201 samples" in told
    other = explore(explorer.page.evaluate("location.hash"))
    assert (other.value("motion"), other.text("motion-summary")) == ("away.csv", told)
    other.page.locator("#time").fill("2")
    other.ready()
    assert float(other.value("pose-y")) == pytest.approx(20, abs=1e-4)
    # Back is the motion before.
    explorer.page.go_back()
    until(explorer.page, "document.querySelector('#motion').value === 'plano-spherical-sinusoids'")
    explorer.ready()
    assert "follows all 1001 samples" in explorer.text("motion-summary")
    assert explore(shipped).value("motion") == "plano-spherical-sinusoids"


def test_a_sum_of_sinusoids_is_followed(explore, opm, tmp_path):
    explorer = explore("#pose.x=10")
    explorer.choose("motion", "sinusoids")
    before = explorer.text("motion-summary")
    explorer.fill(sine_x_amplitude=5, sine_y_amplitude=0, sine_zeta_amplitude=0, sine_xi_amplitude=0, sine_psi_amplitude=0)
    assert explorer.text("motion-summary") != before
    assert "follows all 1001 samples" in explorer.text("motion-summary")
    explorer.page.locator("#time").fill("2.5")
    explorer.ready()
    # 10 mm and 5 mm of a sinusoid at a quarter of its period of 10 s.
    assert float(explorer.value("pose-x")) == pytest.approx(15, abs=1e-4)


def handles(explorer):
    """A place on each handle in the view, by the names of the coordinates that it moves."""
    # The events of a mouse, sent in the page: one by one from outside, thousands of them take half a minute.
    found = explorer.page.locator("#view canvas").evaluate("""canvas => {
        const [box, found] = [canvas.getBoundingClientRect(), {}];
        for (let y = 0.3 * box.height; y < 0.75 * box.height; y += 7) {
            for (let x = 0.25 * box.width; x < 0.8 * box.width; x += 12) {
                const [clientX, clientY] = [Math.round(box.x + x), Math.round(box.y + y)];
                canvas.dispatchEvent(new PointerEvent("pointermove", { clientX, clientY, bubbles: true }));
                if (canvas.title) found[canvas.title] ??= [clientX, clientY];
            }
        }
        return found;
    }""")
    return {title.removeprefix("Drag to change "): place for title, place in found.items()}


def drag(explorer, place):
    """Drags what is at a place of the view to the right, the platform being at home."""
    explorer.page.click("#home")
    explorer.ready()
    x, y = place
    explorer.page.mouse.move(x, y)
    explorer.page.mouse.down()
    explorer.page.mouse.move(x + 20, y + 4, steps=4)
    explorer.page.mouse.up()
    explorer.ready()


def test_the_platform_is_dragged_in_the_view(explore):
    explorer = explore()
    found = handles(explorer)
    assert {"x", "y", "zeta", "xi", "psi", "x, y"} <= set(found)
    for names in ("x", "zeta", "x, y"):
        explorer.page.click("#home")
        explorer.ready()
        drawn = explorer.bodies()
        drag(explorer, found[names])
        moved = [name for name in ("x", "y", "zeta", "xi", "psi") if float(explorer.value(f"pose-{name}")) != 0]
        assert moved == names.split(", ")
        assert explorer.bodies() != drawn
        # x is to the right in the first view.
        assert "x" not in moved or float(explorer.value("pose-x")) > 0
    # Without handles, the same drag turns the view.
    explorer.page.uncheck("#handles")
    drag(explorer, found[names])
    assert explorer.value("pose-x") == "0"


def test_every_unit_of_files_is_understood(browser, opm, tmp_path):
    """The same mechanism at another scale looks the same, so that the same drag is the same number."""
    text = subprocess.run([opm, "examples", "planar-3rpr"], capture_output=True, text=True).stdout
    assert 'length = "mm", angle = "deg"' in text
    moved = {}
    for length, angle, quarter in (("mm", "deg", 90), ("um", "mrad", 500 * math.pi)):
        mechanism, page = tmp_path / f"{length}.toml", tmp_path / f"{length}.html"
        scaled = text.replace('length = "mm", angle = "deg"', f'length = "{length}", angle = "{angle}"')
        # The angles of the file.
        for name in ("start", "turn"):
            value = re.search(rf"{name} = {{ value = ([-.0-9]+)", text)[1]
            scaled = scaled.replace(f"value = {value}", f"value = {float(value) * quarter / 90}")
        mechanism.write_text(scaled)
        subprocess.run([opm, "explore", mechanism, "--quiet", "-o", page], check=True)
        explorer = Explorer(browser, page)
        found, moved[length] = handles(explorer), []
        for name in ("x", "theta"):
            home = float(explorer.value(f"pose-{name}"))
            drag(explorer, found[name])
            moved[length].append(float(explorer.value(f"pose-{name}")) - home)
        # A joint without limits is shown within half a turn about home, where B1 is zero.
        mark = explorer.page.locator("tr:has([id='joint-B1']) .bar b")
        angle_now = float(explorer.text("joint-B1"))
        shown = mark.evaluate("mark => parseFloat(mark.style.left)")
        assert shown == pytest.approx(50 + 25 * angle_now / quarter, abs=0.01) and abs(shown - 50) > 0.05
        turned = float(explorer.value("pose-theta"))
        # The phase of a sinusoid is in degrees in the page, and in the unit of the file in the motion.
        explorer.choose("motion", "sinusoids")
        explorer.fill(sine_x_amplitude=0, sine_y_amplitude=0, sine_theta_amplitude=10, sine_theta_phase=90)
        explorer.page.locator("#time").fill("0.01")
        explorer.page.locator("#time").fill("0")
        explorer.ready()
        assert float(explorer.value("pose-theta")) == pytest.approx(turned + 10, abs=1e-3)
        explorer.close()
    assert abs(moved["mm"][0]) > 0.1 and moved["um"][0] == pytest.approx(moved["mm"][0], rel=1e-3)
    assert abs(moved["mm"][1]) > 0.1 and moved["um"][1] == pytest.approx(math.radians(1e3 * moved["mm"][1]), rel=1e-3)


def test_a_platform_that_turns_as_it_is_shifted_has_arrows(browser, opm, tmp_path):
    """Its angle follows from the place. And two coordinates make no body."""
    page = tmp_path / "five-bar.html"
    subprocess.run([opm, "explore", "five-bar", "--quiet", "-o", page], check=True)
    explorer = Explorer(browser, page)
    drag(explorer, handles(explorer)["x"])
    assert float(explorer.value("pose-x")) > 1
    assert explorer.page.locator("#body-show").is_disabled()
    assert explorer.text("legend").splitlines()[1] == "Links"
    assert explorer.text("summary") == "Mobility 2, joint screws of rank 3: planar"
    explorer.close()
    page = tmp_path / "wrist.html"
    subprocess.run([opm, "explore", "cartesian-wrist-6dof", "--quiet", "-o", page], check=True)
    explorer = Explorer(browser, page)
    assert "translational space and spherical, sharing no motion" in explorer.text("summary")
    explorer.close()


def test_a_page_in_a_frame_of_a_notebook_works(explore, browser, file, tmp_path):
    """Its address is `about:srcdoc`, to which no state can be added."""
    page = file.read_text().replace("&", "&amp;").replace('"', "&quot;")
    framed = tmp_path / "notebook.html"
    framed.write_text(f'<!doctype html><iframe title="page" srcdoc="{page}" style="width: 1200px; height: 780px"></iframe>')
    context = browser.new_context(offline=True)
    opened, wrong = context.new_page(), []
    opened.set_default_timeout(PATIENCE)
    opened.on("pageerror", lambda error: wrong.append(str(error)))
    opened.goto(framed.as_uri())
    frame = opened.frame_locator("iframe")
    frame.locator("body[data-ready=true]").wait_for(state="attached")
    s1 = frame.locator("#joint-S1").input_value()
    frame.locator("#pose-x").fill("30")
    frame.locator("#pose-x").press("Tab")
    frame.locator("body[data-ready=true]").wait_for(state="attached")
    assert frame.locator("#joint-S1").input_value() != s1
    context.close()
    assert wrong == []


OBSTACLES = """
[bodies]
radius = 4

[[obstacle]]
name = "post"
type = "capsule"
from = [90, 60, -500]
to = [90, 60, 500]
radius = 5
"""


def shown_parts(explorer):
    return explorer.page.locator("#legend li:visible").all_inner_texts()


def test_obstacles_are_shown_and_what_is_too_near_is_red(browser, opm, tmp_path):
    mechanism = tmp_path / "post.toml"
    mechanism.write_text((REPOSITORY / f"crates/opm-core/mechanisms/{PLANO}.toml").read_text() + OBSTACLES)
    page = tmp_path / "post.html"
    subprocess.run([opm, "explore", mechanism, "--quiet", "-o", page], check=True)
    explorer = Explorer(browser, page)
    assert "Obstacles" in shown_parts(explorer) and "Bodies too near to each other" not in shown_parts(explorer)

    def told(pose):
        command = [opm, "ik", mechanism, "--pose", pose, "--format", "text"]
        lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
        return next(line for line in lines if line.startswith(("nearest: ", "interference: ")))

    apart = told("x=0")
    assert distance(explorer.text("nearest")) == distance(apart) and apart.endswith("apart")
    explorer.fill(pose_x=90, pose_y=60)
    hit = told("x=90mm,y=60mm")
    assert hit.endswith("overlapping by 9 mm")
    assert distance(explorer.text("nearest")) == distance(hit) and explorer.text("nearest") in explorer.text("status")
    assert "Bodies too near to each other" in shown_parts(explorer)
    seen(explorer, tmp_path / "post.png", "interference")

    # With a clearance, which a link holds, bodies are red before they meet.
    explorer.fill(pose_x=0, pose_y=0)
    assert "Bodies too near to each other" not in shown_parts(explorer)
    explorer.fill(clearance=1000)
    assert "Bodies too near to each other" in shown_parts(explorer)
    other = Explorer(browser, page, explorer.page.evaluate("location.hash"))
    assert other.value("clearance") == "1000" and "Bodies too near to each other" in shown_parts(other)
    other.fill(clearance=-1)
    assert "the clearance is -1 mm, expected 0 or more" in other.text("problems")
    other.fill(clearance="")
    assert other.page.locator("#problems").is_hidden() and "Bodies too near to each other" not in shown_parts(other)
    explorer.close()
    other.close()


# The share of the outermost pixels of the drawing in which there is something.
EDGE = """async (bytes) => {
    const picture = await createImageBitmap(new Blob([new Uint8Array(bytes)], { type: "image/png" }));
    const { width, height } = picture;
    const context = new OffscreenCanvas(width, height).getContext("2d");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    let filled = 0, all = 0;
    for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) {
        const outer = x === 0 || y === 0 || x === width - 1 || y === height - 1;
        if (outer) [filled, all] = [filled + (data[4 * (y * width + x) + 3] > 0), all + 1];
    }
    return filled / all;
}"""


def test_a_body_that_is_larger_than_the_mechanism_is_seen_from_outside(explore):
    for start in ["", "&body=any"]:
        explorer = explore(f"#example=planar-3rpr{start}")
        if not start:
            explorer.page.click("#body-show")
            explorer.ready()
        explorer.page.uncheck("#handles")
        edge = lambda: explorer.page.evaluate(EDGE, list(explorer.bodies()))  # noqa: B023, E731
        assert edge() == 0
        explorer.page.focus("#view")
        for _ in range(8):
            explorer.page.keyboard.press("+")
        assert edge() > 0
        explorer.page.click("#fit")
        assert edge() == 0


# How many pixels of the drawing are at its edge, or under what is laid over it.
HIDDEN = """async (bytes) => {
    const picture = await createImageBitmap(new Blob([new Uint8Array(bytes)], { type: "image/png" }));
    const { width, height } = picture;
    const context = new OffscreenCanvas(width, height).getContext("2d");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const view = document.getElementById("view").getBoundingClientRect();
    const boxes = ["legend", "viewing", "status"].map((id) => document.getElementById(id).getBoundingClientRect());
    let hidden = 0;
    for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) {
        if (!data[4 * (y * width + x) + 3]) continue;
        const [across, down] = [view.left + (x * view.width) / width, view.top + (y * view.height) / height];
        const under = boxes.some((box) => across > box.left && across < box.right && down > box.top && down < box.bottom);
        hidden += under || x === 0 || y === 0 || x === width - 1 || y === height - 1;
    }
    return hidden;
}"""


@pytest.mark.parametrize("width, height", [(1280, 900), (360, 740)])
def test_the_view_shows_all_of_it(explore, width, height):
    """At first, and from another side: joints and handles too, beside the legend, the buttons and the text."""
    for name in ["double-spherical-5dof", "sarrus", "planar-3rrr"]:
        explorer = explore(f"#example={name}", viewport={"width": width, "height": height})
        hidden = lambda: explorer.page.evaluate(HIDDEN, list(explorer.bodies()))  # noqa: B023, E731
        assert hidden() == 0, name
        explorer.page.focus("#view")
        for key in ["ArrowLeft"] * 8 + ["+"] * 8:
            explorer.page.keyboard.press(key)
        assert hidden() > 0, name
        explorer.page.keyboard.press("f")
        assert hidden() == 0, name


# The fields whose numbers and the dimensions whose names are cut.
CUT = """() => [...document.querySelectorAll("input[type=number], #dimensions label")]
    .filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => `${one.id} ${one.value ?? one.textContent}`)"""


def test_numbers_and_names_are_not_cut(explore):
    """A number that is cut reads as another, and names that are cut are all the same."""
    explorer = explore("#example=plano-spherical-5dof-joints")
    # Rounding of the home pose.
    assert [explorer.value(f"pose-{name}") for name in ("x", "y")] == ["0", "0"]
    for width, height in [(1280, 900), (1050, 800), (360, 740)]:
        explorer.page.set_viewport_size({"width": width, "height": height})
        assert explorer.page.evaluate(CUT) == [], width
    # What a field does not show of a number is kept where its neighbour is changed.
    assert explorer.value("param-S1.point.x") == "103.923048"
    explorer.enter("param-S1.point.y", 61)
    [x] = re.findall(r"set\.S1\.point=([\d.]+)%3A61%3A", explorer.page.evaluate("location.hash"))
    assert float(x) == pytest.approx(60 * math.sqrt(3), abs=1e-9)


def test_a_slice_has_as_many_values_as_its_fields_say(explore):
    explorer = explore()
    before = explorer.count()
    for wrong in ["100000", "0", "1.5"]:
        explorer.page.fill("#slice-nx", wrong)
        explorer.page.keyboard.press("Enter")
        explorer.ready()
        assert f"{wrong}, expected a whole number from 1 to 2001" in explorer.text("problems")
        assert (explorer.value("slice-nx"), explorer.count()) == ("201", before)
    explorer.fill(slice_nx=101)
    assert explorer.page.locator("#problems").is_hidden() and explorer.count().endswith(f" of {101 * 201}")
    assert "slice.nx=2002: expected a whole number from 1 to 2001" in explore("#slice.nx=2002").text("problems")


def test_a_mechanism_with_one_coordinate_has_no_slice(explore):
    explorer = explore("#example=sarrus")
    assert "A slice needs two coordinates" in explorer.text("slice")
    assert not explorer.page.locator("#slice-canvas").is_visible() and not explorer.page.locator("#slice-nx").is_visible()
    assert " of " in explorer.text("whole-count")


def test_messages_are_about_the_file_that_was_opened_last(explore, opm, tmp_path):
    explorer = explore()
    names = ["binary.mcap", "broken.toml", "latin.csv", "motion.toml"]
    contents = [b"\x89MCAP0\r\n\x01\xff", b"format = 1\nname = 3\n", b"time,x\n0,\xe9\n", b"format = 1\nduration = -1\n"]
    for name, content in zip(names, contents, strict=True):
        (tmp_path / name).write_bytes(content)
        explorer.page.set_input_files("#file", tmp_path / name)
        until(explorer.page, "(name) => document.querySelector('#problems').textContent.includes(name)", arg=name)
        explorer.ready()
        told = explorer.page.locator("#problems div").inner_text().splitlines()
        assert all(line.startswith(f"{name}:") for line in told), told
        if "UTF-8" in told[0]:
            # On the line that the command names.
            run = subprocess.run([opm, "decompose", tmp_path / name], capture_output=True, text=True)
            assert told[0].partition(",")[0] in run.stderr and len(told) == 1
    assert explorer.text("title") == PLANO


def test_dimensions_are_undone_from_every_field(explore):
    explorer = explore()
    height = lambda: explorer.value("param-leg1.h")  # noqa: E731
    press = lambda key: (explorer.page.keyboard.press(key), explorer.ready())  # noqa: E731
    explorer.page.fill("[id='param-leg1.h']", "140")
    press("Enter")
    # In the field itself, and in one of the pose, in which nothing is being typed.
    press("Control+z")
    assert height() == "120"
    explorer.page.focus("#pose-x")
    press("Control+Shift+Z")
    assert height() == "140"
    press("Control+z")
    assert height() == "120"
    # What is being typed is undone alone.
    press("Control+Shift+Z")
    explorer.page.keyboard.type("37")
    press("Control+z")
    assert height() == "140" and explorer.value("pose-x") != "37"


def test_an_emptied_coordinate_goes_to_the_home_of_the_changed_mechanism(explore):
    explorer = explore("#example=delta")
    explorer.enter("param-crank", 700)
    # The cranks are level at home: the rods' 1244 mm span 164 + 700 - 44 mm outwards and the height.
    height = -((1244**2 - (164 + 700 - 44) ** 2) ** 0.5)
    assert abs(float(explorer.value("pose-z")) - height) < 1e-3
    explorer.enter("pose-z", -1000)
    explorer.enter("pose-z", "")
    assert abs(float(explorer.value("pose-z")) - height) < 1e-3


def test_a_saved_pose_of_dependent_coordinates_is_read_back(explore, opm, tmp_path):
    explorer = explore("#example=five-bar&pose.x=20&pose.y=300")
    saved = tmp_path / "pose.csv"
    with explorer.page.expect_download() as download:
        explorer.page.select_option("#save", "pose")
    download.value.save_as(saved)
    head, row = (line.split(",") for line in saved.read_text().splitlines())
    assert head[:3] == ["x [mm]", "y [mm]", "theta [deg]"]
    run = subprocess.run([opm, "ik", "five-bar", "--poses", saved], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    solved = dict(zip(*(line.split(",") for line in run.stdout.splitlines()), strict=True))
    assert float(solved["theta"]) == pytest.approx(float(row[2]) * 3.141592653589793 / 180, abs=1e-9)
    # A value that does not follow is refused.
    saved.write_text(saved.read_text().replace(row[2], "3"))
    run = subprocess.run([opm, "ik", "five-bar", "--poses", saved], capture_output=True, text=True)
    assert run.returncode == 1 and f"{saved}:2: theta is given as 3 deg, but follows" in run.stderr


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_is_accessible(explore, scheme):
    if not AXE.exists():
        pytest.skip(f"no {AXE.relative_to(REPOSITORY)}: accessibility was not checked; npm ci in web/ gets it")
    explorer = explore("#kind=dexterous&kind.turn=5&body=pose", color_scheme=scheme)
    explorer.choose("motion", "sinusoids")
    explorer.page.evaluate(AXE.read_text())
    found = explorer.page.evaluate("axe.run(document)")
    assert len(found["passes"]) > 30
    serious = [(v["id"], v["nodes"][0]["html"]) for v in found["violations"] if v["impact"] in ("serious", "critical")]
    assert serious == []


# Asks the library that a page holds, by the page's own worker.
ASK = """async (requests) => {
    const held = (id) => document.getElementById(id).textContent;
    const packed = Uint8Array.from(atob(held("opm-library")), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const worker = new Worker(URL.createObjectURL(new Blob([held("opm-worker")], { type: "text/javascript" })));
    const ask = (message) => new Promise((resolve) => {
        worker.onmessage = ({ data }) => resolve(data.failed ?? data.text);
        worker.postMessage(message);
    });
    await ask(await new Response(stream).arrayBuffer());
    const answers = [];
    for (const request of requests) answers.push(await ask(request));
    worker.terminate();
    return answers;
}"""


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def same(one, other, place=""):
    """Whether two answers are equal; numbers but for rounding, which other compilers of functions such as the sine do elsewhere."""
    assert type(one) is type(other) or {type(one), type(other)} <= {int, float}, place
    if isinstance(one, dict):
        assert list(one) == list(other), place
        for name in one:
            same(one[name], other[name], f"{place}.{name}")
    elif isinstance(one, list):
        assert len(one) == len(other), place
        for number, (a, b) in enumerate(zip(one, other, strict=True)):
            same(a, b, f"{place}[{number}]")
    elif isinstance(one, (int, float)) and not isinstance(one, bool):
        assert one == pytest.approx(other, rel=1e-9, abs=1e-7), place
    elif place.endswith(".nearest"):
        # Of two pairs that are equally near, rounding decides which is named.
        assert distance(one) == distance(other), place
    elif isinstance(one, str):
        # So are the numbers of a file.
        assert NUMBER.split(one) == NUMBER.split(other), place
        same(*[[float(number) for number in NUMBER.findall(text)] for text in (one, other)], place)
    else:
        assert one == other, place


def distance(nearest):
    """What is said of the nearest two bodies, without their names."""
    return nearest.partition(":")[0].lower(), nearest.rpartition(", ")[2].rstrip(".")


def test_the_stored_page_answers_as_this_version_does(programs, explore):
    """Descriptions, poses, counts of sweeps and motions of the stored page are those of the library that is compiled now. Where
    they are not, `make web` builds the page anew."""
    requests = []
    for name in [PLANO, "translational-helical-3dof", "planar-3rpr", "agile-eye", "five-bar", "schoenflies-4dof"]:
        text = (REPOSITORY / f"crates/opm-core/mechanisms/{name}.toml").read_text()
        poses = {PLANO: {"x": 10, "xi": 15}, "planar-3rpr": {"theta": 3}, "five-bar": {"x": 20, "y": 300}}
        pose = poses.get(name, {})
        requests += [{"do": "open", "name": f"{name}.toml", "text": text}, {"do": "pose", "pose": pose, "clearance": 3}]
        if name == PLANO:
            x, y, xi = ({"name": axis, "min": -150, "max": 150, "count": 61} for axis in ("x", "y", "xi"))
            requests += [{"do": "slice", "x": x, "y": y}, {"do": "slice", "x": y, "y": xi, "pose": {"psi": 5}, "mode": "-+ ++ +- -"}]
            requests += [{"do": "slice", "x": x, "y": y, "pose": {"zeta": -7.5}}, {"do": "fit"}, {"do": "whole"}, {"do": "kinds"}]
            requests += [{"do": "motions"}, {"do": "change", "changes": {"leg1.h": [140]}}, {"do": "file"}]
    lines = [json.dumps(request) for request in requests]
    run = subprocess.run(
        [programs["answers"]], input="".join(f"{line}\n" for line in lines), capture_output=True, text=True, check=True
    )
    stored = explore().page.evaluate(ASK, lines)
    for request, page, native in zip(requests, stored, run.stdout.splitlines(), strict=True):
        assert "problems" not in native, request
        page, native = json.loads(page), json.loads(native)
        if "reachable" in native:
            assert (page["reachable"], page["poses"]) == (native["reachable"], native["poses"])
        same(page, native, f"{request['do']} (make web?)")


def has_compiler():
    """Whether the page can be built here without fetching anything, as `web/build.sh` decides it."""
    if not (PACKAGES / "esbuild").exists() or shutil.which("node") is None:
        return False
    if Path("/usr/bin/rustc").exists() and shutil.which("wasm-ld-19"):
        return True
    command = ["rustc", "--print", "target-libdir", "--target", "wasm32-unknown-unknown"]
    libraries = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True)
    return libraries.returncode == 0 and Path(libraries.stdout.strip()).is_dir()


def test_the_stored_page_answers_as_one_that_is_built_anew(browser, explore, file, tmp_path, workspace):
    if not has_compiler():
        pytest.skip("no node packages in web/, or no compiler for WebAssembly: the page was not built anew")
    packed = tmp_path / "anew.html.gz"
    subprocess.run([REPOSITORY / "web/build.sh", packed], check=True, stdin=subprocess.DEVNULL)
    # The mechanism file is put into both in the same way.
    empty = '<script type="application/json" id="opm-file">null</script>'
    place = gzip.decompress(STORED.read_bytes()).decode().index(empty)
    stored = file.read_text()
    given = stored[place : stored.index("</script>", place) + len("</script>")]
    built = gzip.decompress(packed.read_bytes()).decode()
    assert built.count(empty) == 1
    anew = tmp_path / "anew.html"
    anew.write_text(built.replace(empty, given))
    [stamp] = re.findall(r'content="opm [^"]+"', stored)
    assert stamp in built

    pages = [explore(), Explorer(browser, anew)]
    planes = [("x", "y", {}), ("zeta", "xi", {"x": 12.5}), ("psi", "x", {"xi": -20, "y": 30})]
    units = {"x": "mm", "y": "mm", "zeta": "deg", "xi": "deg", "psi": "deg"}
    for across, upwards, pose in planes:
        address = "&".join([f"slice.x={across}", f"slice.y={upwards}", "slice.nx=91", "slice.ny=77",
                            "slice.xmin=-150", "slice.xmax=150", "slice.ymin=-60", "slice.ymax=60",
                            *(f"pose.{name}={value}" for name, value in pose.items())])  # fmt: skip
        grid = [f"{across}=-150{units[across]}:150{units[across]}:91", f"{upwards}=-60{units[upwards]}:60{units[upwards]}:77"]
        grid += [f"{name}={value}{units[name]}" for name, value in pose.items()]
        answer = workspace(PLANO, *(part for one in grid for part in ("--grid", one)))
        shown = []
        for explorer in pages:
            explorer.page.evaluate("(hash) => { location.hash = hash; }", address)
            until(explorer.page, "(name) => document.querySelector('#slice-x').value === name", arg=across)
            explorer.ready()
            joints = explorer.page.locator("#joints input, #joints output")
            values = joints.evaluate_all("(all) => all.map((one) => [one.id, one.value ?? one.textContent])")
            shown.append((explorer.count(), values))
        assert shown[0] == shown[1]
        assert shown[0][0] == expected(answer)
    pages[1].close()


def test_it_is_drawn_in_time(explore, tmp_path):
    """Prints what a slice, the whole workspace, its body and a frame take while a dimension is dragged."""
    explorer = explore()
    still = explorer.page.evaluate(STILL)
    frames = """async (steps) => {
        const slider = document.querySelector("[aria-label='h, slider']");
        const body = document.body, slices = [], wholes = [], bodies = [], drawn = [];
        const low = Number(slider.value);
        let last = performance.now();
        for (let i = 1; i <= steps; i++) {
            slider.value = String(low + i / 2);
            slider.dispatchEvent(new Event("input", { bubbles: true }));
            await new Promise(requestAnimationFrame);
            const now = performance.now();
            drawn.push(now - last);
            last = now;
            slices.push(Number(body.dataset.sliceMs));
            wholes.push(Number(body.dataset.wholeMs));
            bodies.push(Number(body.dataset.bodyMs));
        }
        const middle = (list) => list.sort((a, b) => a - b)[Math.floor(list.length / 2)];
        return [slices, wholes, bodies, drawn].map(middle);
    }"""
    slice_time, whole_time, _, frame_time = explorer.page.evaluate(frames, 60)
    explorer.ready()
    explorer.page.click("#body-show")
    explorer.choose("body-others", "any")
    *_, body_time, with_body = explorer.page.evaluate(frames, 60)
    explorer.ready()
    print(f"slice {slice_time:.2f} ms, whole workspace {whole_time:.1f} ms, body of the whole {body_time:.1f} ms")
    print(f"frame {frame_time:.1f} ms while a dimension is dragged, {with_body:.1f} ms with the body, {still:.1f} ms at best")
    # Far above what is measured, and far below what somebody would wait for: the machine may be busy.
    assert slice_time < 200 and whole_time < 2000 and body_time < 2000 and frame_time < 1000


# A desktop, a phone upright and on its side, and a small window.
SCREENS = [(*size, scheme) for size in [(1400, 900), (390, 844), (844, 390), (1050, 800)] for scheme in ("light", "dark")]


@pytest.mark.parametrize("width, height, scheme", SCREENS)
def test_it_fits_the_screen(explore, tmp_path, width, height, scheme):
    explorer = explore(viewport={"width": width, "height": height}, color_scheme=scheme)
    seen(explorer, tmp_path / f"{width}x{height}-{scheme}.png", "picture")
    assert explorer.page.evaluate("document.documentElement.scrollWidth") <= width
    # Nothing that is laid over the view hides another, and the mechanism has room.
    boxes = [explorer.page.locator(f"#{name}").bounding_box() for name in ("legend", "viewing", "status")]
    for one, other in itertools.combinations(boxes, 2):
        beside = one["x"] + one["width"] <= other["x"] or other["x"] + other["width"] <= one["x"]
        below = one["y"] + one["height"] <= other["y"] or other["y"] + other["height"] <= one["y"]
        assert beside or below, (one, other)
    stage = explorer.page.locator("#stage").bounding_box()
    assert stage["height"] >= 300 and stage["width"] >= 300
    assert sum(box["width"] * box["height"] for box in boxes) < 0.5 * stage["width"] * stage["height"]
    dark = explorer.page.evaluate("document.documentElement.dataset.theme") == "dark"
    assert dark == (scheme == "dark")
