"""Checks the links of a built site: every file that a page refers to exists, and every place in it. No network is used;
what leads elsewhere is counted only.

    python docs/site/check_links.py target/site
"""

import sys
from collections import defaultdict
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The places in a page, and what it refers to."""

    def __init__(self, path):
        super().__init__()
        self.places, self.references = set(), []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.places.add(value)
            elif name in ("href", "src") and value and (tag, name) != ("base", "href"):
                self.references.append(value)


def broken(site):
    """The references that lead nowhere, as texts, and the numbers of those that were followed and that leave the site."""
    pages, counts, found = {}, defaultdict(int), []

    def page(path):
        if path not in pages:
            pages[path] = Page(path)
        return pages[path]

    # The reference of the crates is rustdoc's own, which checks its links, and pages of the explorer have none.
    written = [path for path in sorted(site.rglob("*.html")) if path.relative_to(site).parts[0] not in ("rust", "explorer")]
    for path in written:
        for reference in page(path).references:
            parts = urlsplit(reference)
            if parts.scheme or parts.netloc:
                counts["outside"] += 1
                continue
            counts["inside"] += 1
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists():
                found.append(f"{path.relative_to(site)}: {reference}: no such file")
            elif parts.fragment and target.suffix == ".html" and unquote(parts.fragment) not in page(target).places:
                found.append(f"{path.relative_to(site)}: {reference}: no such place")
    return found, counts


if __name__ == "__main__":
    found, counts = broken(Path(sys.argv[1]).resolve())
    print(*found, sep="\n", end="\n" if found else "")
    print(f"{counts['inside']} links lead to something, {counts['outside']} leave the site" if not found else f"{len(found)} broken")
    sys.exit(bool(found) or not counts["inside"])
