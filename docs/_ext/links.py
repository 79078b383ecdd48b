"""Check the links of the built pages: every file, picture and anchor of the site exists.

    python docs/_ext/links.py docs/_build/html

Pages of other sites are counted and not asked: the documentation builds without a network.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The links and anchors of one page."""

    def __init__(self, path: Path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        """Keep what leads somewhere, and what can be led to."""
        found = dict(attributes)
        self.links += [found[name] for name in ("href", "src") if found.get(name)]
        self.anchors |= {found[name] for name in ("id", "name") if found.get(name)}


def broken(site: Path) -> tuple[list[str], int, int]:
    """Sentences on links that lead nowhere, and how many were inside and outside of the site."""
    pages = {path.resolve(): Page(path) for path in sorted(site.rglob("*.html"))}
    found, inside, outside = [], 0, 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                outside += 1
                continue
            inside += 1
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists():
                found.append(f"{path.relative_to(site.resolve())}: {link}: no such file")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                found.append(f"{path.relative_to(site.resolve())}: {link}: no such place")
    return found, inside, outside


if __name__ == "__main__":
    sentences, inside, outside = broken(Path(sys.argv[1]))
    print("\n".join([*sentences, f"{inside} links inside, {len(sentences)} broken; {outside} outside"]))
    sys.exit(bool(sentences))
