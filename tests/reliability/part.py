"""The frame of a part: PART.py [--thorough] [-o FILE.json]; exit code 1 on any failure, rows of counted results for the page."""

import argparse
import datetime
import json
import os
import subprocess
import sys
import time

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def git(*words):
    return subprocess.run(["git", "-C", SOURCE, *words], capture_output=True, text=True, check=False).stdout.strip()


def state():
    """The commit that is measured, taken when a part begins."""
    changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!tests/reliability/measured", ":!docs/reliability.md")
    return (git("rev-parse", "--short=10", "HEAD") or "unknown") + (" with changes" if changed else "")


BEGUN, AT = time.monotonic(), state()


def measured():
    """When and of what the figures are: the page holds those of several runs."""
    return {"on": datetime.date.today().isoformat(), "at": AT, "cores": os.cpu_count(),
            "minutes": round((time.monotonic() - BEGUN) / 60.0, 1)}


def save(page, path):
    """Keeps what page.py makes a section of."""
    with open(path, "w", encoding="utf-8") as file:
        json.dump({**page, "measured": measured()}, file, indent=1)


class Part:
    def __init__(self, name, title):
        self.page = {"part": name, "title": title, "rows": [], "notes": []}
        self.failures = []

    def require(self, right, text):
        if not right:
            self.failures.append(text)
            print("FAILED:", text, file=sys.stderr, flush=True)

    def row(self, what, count, result):
        print(f"{what}: {count}: {result}", flush=True)
        self.page["rows"].append({"what": what, "count": count, "result": result})

    def note(self, text):
        print(text, flush=True)
        self.page["notes"].append(text)


def main(name, title, work):
    """work(part, thorough) counts; a failure anywhere ends with 1, and no page is made of it. With titles by name instead of one title
    the program takes one of these names, and work takes it, too."""
    parser = argparse.ArgumentParser(description=title if isinstance(title, str) else ", ".join(title.values()))
    if not isinstance(title, str):
        parser.add_argument("choice", choices=title)
    parser.add_argument("--thorough", action="store_true", help="the long form, whose figures go on the page")
    parser.add_argument("-o", metavar="FILE.json", help="where the rows of the page go")
    options = parser.parse_args()
    if isinstance(title, str):
        part = Part(name, title)
        work(part, options.thorough)
    else:
        part = Part(f"{name} {options.choice}", title[options.choice])
        work(part, options.thorough, options.choice)
    if part.failures:
        sys.exit(f"{len(part.failures)} failures")
    if options.o:
        save(part.page, options.o)
