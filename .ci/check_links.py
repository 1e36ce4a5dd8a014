"""Checks that every relative link, picture and anchor of a directory of HTML pages leads somewhere."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag


class Page(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.targets: "list[str]" = []
        self.anchors: "set[str]" = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: "list[tuple[str, str | None]]") -> None:
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.anchors.add(value)
            if name in ("href", "src") and value:
                self.targets.append(value)


def main(directory: Path) -> int:
    pages = {path.resolve(): Page(path.read_text("utf-8")) for path in directory.rglob("*.html")}
    broken, checked = [], 0
    for path, page in pages.items():
        # Of all pages one after the other, for printing; and the page for addresses that do not exist.
        if path.name in ("print.html", "404.html", "toc.html"):
            continue
        for target in page.targets:
            link, anchor = urldefrag(unquote(target))
            if ":" in link.split("/")[0]:
                continue
            to = (path.parent / link).resolve() if link else path
            to = to / "index.html" if to.is_dir() else to
            checked += 1
            if not to.exists():
                broken.append(f"{path.name}: {target}: there is no such file")
            elif anchor and to in pages and anchor not in pages[to].anchors:
                broken.append(f"{path.name}: {target}: there is no such anchor")
    print(f"{len(pages)} pages, {checked} links", *broken, sep="\n")
    return 1 if broken or not pages else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
