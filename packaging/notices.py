"""Writes the licences of everything that is part of the program and of the wheel: `make notices`, which needs cargo-about.

They go to cli/THIRD-PARTY.txt, which `opm licenses` prints, and to py/THIRD-PARTY.txt, which is in the wheel: a package
holds no file from outside of its folder. `tests/python/test_notices.py` compares them with Cargo.lock.

    python packaging/notices.py [OUTPUT OF CARGO ABOUT]
"""

import gzip
import re
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
RULE = "-" * 80 + "\n"


def crates():
    """The licences of the crates, without those of opm itself."""
    if len(sys.argv) > 1:
        text = Path(sys.argv[1]).read_text(encoding="utf-8")
    else:
        about = ["cargo", "about", "generate", "--workspace", "--offline", "--locked", "about.hbs"]
        text = subprocess.run(about, cwd=REPOSITORY, check=True, stdout=subprocess.PIPE, text=True).stdout
    for section in text.split(RULE):
        heading, _, rest = section.strip("\n").partition("\n")
        users, _, licence = rest.partition("\n\n")
        names = sorted(line.strip() for line in users.splitlines() if not line.strip().startswith("opm-"))
        if names:
            yield heading, names, "\n".join(line.rstrip() for line in licence.strip("\n").splitlines())


def page():
    """What the explorer's page says of its own parts: three.js first."""
    text = gzip.decompress((REPOSITORY / "crates/opm-export/page/explorer.html.gz").read_bytes()).decode("utf-8")
    notice = re.search(r"three\.js [\d.]+:\n.*?(?=Rust crates in the compiled library)", text, re.DOTALL)
    return notice[0].strip("\n")


def main():
    sections = list(crates())
    every = sorted({name for _, names, _ in sections for name in names})
    parts = [
        "What is part of opm besides its own code, and under which licences.\n\nCrates:\n",
        *(f"  {name}\n" for name in every),
        "\nThe fonts DejaVu Sans and DejaVu Sans Bold, in figures.\nthree.js, in the page of the explorer.\nThe standard library of Rust, MIT OR Apache-2.0.\n",
        f"\n{RULE}DejaVu Sans, DejaVu Sans Bold\n\n",
        (REPOSITORY / "crates/opm-plot/fonts/LICENSE").read_text(encoding="utf-8").strip("\n"),
        f"\n\n{RULE}{page()}\n",
        *(f"\n{RULE}{heading}\n" + "".join(f"  {n}\n" for n in names) + f"\n{licence}\n" for heading, names, licence in sections),
    ]
    for place in ("cli", "py"):
        (REPOSITORY / place / "THIRD-PARTY.txt").write_text("".join(parts), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
