"""Writes the tables of dimensions in docs/gallery/README.md, from the files of the shipped mechanisms.

    python docs/gallery/dimensions.py            # writes them
    python docs/gallery/dimensions.py --check    # fails where they are not those of the files

A table stands behind the drawing of the joints at home, between two comments. `tests/python/test_gallery.py` runs the check, and
the command below each table.
"""

import re
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
MECHANISMS = HERE.parents[1] / "crates" / "opm-core" / "mechanisms"
BEGIN, END = "<!-- dimensions -->", "<!-- end of dimensions -->"
SECTION = re.compile(r"^## (?P<name>[\w-]+)\n\n(?P<drawing>!\[Joints at home\][^\n]*\n)(?:\n<!-- dimensions -->\n.*?<!-- end of dimensions -->\n)?", re.M | re.S)
# The dimension that the command below a table changes, and by how much, where 5 % more of the first one does not assemble.
CHANGED = {"planar-3rpr": ("b23", 1.05)}


def number(value):
    return f"{round(value, 4):g}"


def point(value):
    return f"({', '.join(map(number, value))})" if all(isinstance(c, int | float) for c in value) else None


def shown(entry, units):
    """The value of a parameter with its unit; `None` if it follows from others."""
    entry = entry if isinstance(entry, dict) else {"value": entry}
    value = entry["value"]
    text = point(value) if isinstance(value, list) else number(value) if isinstance(value, int | float) else None
    unit = units.get(entry.get("unit"), "")
    # Numbers that are typed as an expression are given, too.
    if text is None and isinstance(value, str) and not re.search(r"[a-zA-Z_]+(?![\w(])", value):
        return f"`{value}` {unit}"
    return text and f"{text} {unit}".rstrip()


def named(mechanism):
    """The rows of the parameters that a file names, and one that can be set."""
    units = mechanism["units"]
    rows, first = [], None
    for name, entry in mechanism["parameters"].items():
        value = shown(entry, units)
        if value is None or value.startswith("(0, 0, 0)"):
            continue
        text = entry.get("text", "") if isinstance(entry, dict) else ""
        rows.append(f"| `{name}` | {value} | {text} |")
        if first is None and isinstance(entry, dict) and isinstance(entry["value"], int | float):
            first = name, entry["value"], units.get(entry.get("unit"), "")
    return ["| dimension | value | |", "|---|---:|---|", *rows], first


def of_family(mechanism):
    """The dimensions of a family's legs, a column for each leg."""
    units = mechanism["units"]
    legs = [leg for key in ("slider_leg", "leg", "arm_leg") for leg in listed(mechanism.get(key, []))]
    keys = list(dict.fromkeys(key for leg in legs for key in leg if key not in ("name", "limits")))
    rows = []
    for key in keys:
        cells = (leg.get(key, "") for leg in legs)
        rows.append(f"| `{key}` | {' | '.join(point(c) if isinstance(c, list) else number(c) if c != '' else '' for c in cells)} |")
    head = [f"| {units['length']}, {units['angle']} | {' | '.join(leg['name'] for leg in legs)} |", f"|---|{'---:|' * len(legs)}"]
    first = next(key for key in ("h", "k") if key in legs[0])
    return head + rows, (f"leg1.{first}", legs[0][first], units["length"])


def listed(value):
    return value if isinstance(value, list) else [value]


def table(name):
    """The lines of a mechanism's table; none where all is in right angles, without dimensions."""
    mechanism = tomllib.loads((MECHANISMS / f"{name}.toml").read_text(encoding="utf-8"))
    if "parameters" in mechanism:
        rows, (key, value, unit) = named(mechanism)
    elif "family" in mechanism:
        rows, (key, value, unit) = of_family(mechanism)
    else:
        return []
    key, factor = CHANGED.get(name, (key, 1.05))
    if name in CHANGED:
        value = mechanism["parameters"][key]["value"]
    changed = f"{key}={number(value * factor)}{unit}"
    return [*rows, "", f"To change one: `opm decompose {name} --set {changed}`, and so in every command."]


def written(page):
    """The page with the tables of today's files."""

    def section(match):
        lines = table(match["name"])
        text = "\n".join([BEGIN, "", *lines, "", END])
        return f"## {match['name']}\n\n{match['drawing']}" + (f"\n{text}\n" if lines else "")

    return SECTION.sub(section, page)


def main():
    page = PAGE.read_text(encoding="utf-8")
    new = written(page)
    if "--check" in sys.argv[1:]:
        if new != page:
            sys.exit(f"{PAGE}: the tables are not those of the files, expected those that `python {sys.argv[0]}` writes")
    else:
        PAGE.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
