"""Hostile text in every place of a page that a file can fill: names, notes, paths, options, warnings, columns, file names.

Each page is made twice, with plain words and with the same words followed by hostile text, and parsed by Chromium. Both must be
the same tree, element by element, but for that text, which must stand there letter by letter; no script of it may run, and
nothing be asked for."""

import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

sys.path.insert(0, os.path.join(os.environ["GROUSER_SOURCE_DIR"], "tests", "pipeline"))
from command import DATA, SOURCE_DIR, run  # noqa: E402
from part import main  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
SEED = 20261122
# What a file may fill with free text, by the key above it.
FREE = {"name", "note", "specimen", "message", "meaning", "limit", "text", "path", "command", "termination", "options",
        "synthetic_note", "synthetic", "test"}
RUN_ONLY = {"vehicle", "bushing"}  # names in run.json, references in scenario.json
WORD = re.compile("zq[0-9]{4}zq")
HIT = "window.grouserHit=1"
PIECES = ["<", ">", '"', "'", "&", "`", "/", "=", "\\", "{", "}", "{{", "}}", "{{{page_title}}}", "{{#runs}}", "{{> partial_run}}",
          "</script>", "<script>" + HIT + "</script>", "<!--", "-->", "]]>", "<![CDATA[", "</style>", "</title>", "<plaintext>",
          "</textarea>", "</svg>", "</table>", "<x-grouser>", f"<img src=x onerror={HIT}>", f'" onmouseover="{HIT}', f"' onfocus='{HIT}",
          f"<svg onload={HIT}>", f"<a href=javascript:{HIT}>", "<iframe src=//127.0.0.1:9>", "<base href=//127.0.0.1:9>", "<form>",
          "&lt;", "&#60;", "&amp;lt;", "\\u003c", "\u2028", "\u2029", "\u202e", "\u00fc", "\U0001d54f", "\ufeff", "${1}", "%3Cscript%3E",
          "url(//127.0.0.1:9)", "@import", "expression(1)", "\t", "\n", " "]


class Words:
    """zq0000zq, zq0001zq, ..., each followed by its own hostile text, or by nothing."""

    def __init__(self, hostile):
        self.hostile, self.count = hostile, 0

    def next(self):
        word = f"zq{self.count:04d}zq"
        text = word + (self.hostile[self.count % len(self.hostile)] if self.hostile else "")
        self.count += 1
        return text


def filled(value, words, keys, free=False):
    """The document with its free texts replaced."""
    if isinstance(value, dict):
        return {key: filled(item, words, keys, free or key in keys) for key, item in value.items()}
    if isinstance(value, list):
        return [filled(item, words, keys, free) for item in value]
    return words.next() if free and isinstance(value, str) and value else value


def fill(folder, words):
    for name in ("run/run.json", "run/inputs/vehicle.json", "run/inputs/scenario.json", "run/inputs/bushing.json", "fit/fit.json"):
        path = os.path.join(folder, name)
        with open(path, encoding="utf-8") as file:
            document = json.load(file)
        keys = FREE | RUN_ONLY if name == "run/run.json" else FREE
        with open(path, "w", encoding="utf-8") as file:
            json.dump(filled(document, words, keys), file)


def file_name(text):
    return text.replace("/", "|").replace("\n", " ").replace("\t", " ").encode()[:200].decode(errors="ignore")


def pages_of(home, whole, hostile):
    """The pages, and what stands in them: word -> its text."""
    folder = os.path.join(home, "filled")  # one name, for pages show it
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(whole, folder)
    words = Words(hostile)
    fill(folder, words)
    # The command that repeats a page quotes them for a shell: so it does with the plain ones, for their space.
    column, table = ["a " + words.next().replace("'", "") for _ in range(2)]
    if hostile is not None:  # quotes, commas and line ends are the table's own, = is that of the option
        column = "".join(letter for letter in column if letter not in '",;\n\t=\ufeff\u2028\u2029').strip()
        table = file_name(table)
    measured = os.path.join(folder, table + ".csv")
    with open(measured, "w", encoding="utf-8") as file:
        file.write(f"time_s,{column}_m_per_s\n" + "".join(f"{0.002 * i},{0.1 * (i % 7)}\n" for i in range(100)))
    run("report", "fit", "run", "-o", "page.html", cwd=folder)
    run("report", "run", "run", "-o", "comparison.html", cwd=folder)
    run("report", "run", "--against", measured, "--channel", f"{column}=speed", "-o", "against.html", cwd=folder)
    run("plot", "run", "--figure", "tension", "-o", "tension.svg", cwd=folder)
    xml.etree.ElementTree.parse(os.path.join(folder, "tension.svg"))
    texts = {f"zq{i:04d}zq": (hostile[i % len(hostile)] if hostile else "") for i in range(words.count)}
    texts[column[2:10]], texts[table[2:10]] = column[10:], table[10:]
    return [os.path.join(folder, name) for name in ("page.html", "comparison.html", "against.html")], texts


def as_browsers_read(text):
    """What HTML cannot hold as it was: line ends are all one."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def expected(text, texts):
    """The plain text with every word's hostile text behind it."""
    return as_browsers_read(WORD.sub(lambda word: word[0] + texts[word[0]], text))


def kinds(node):
    """Every kind of element with its attributes' names, and every text that holds a word."""
    if isinstance(node, str):
        return set(), {node} if WORD.search(node) else set()
    elements, texts = {(node["tag"], *sorted(node["attributes"]))}, set()
    for child in node["children"]:
        more = kinds(child)
        elements, texts = elements | more[0], texts | more[1]
    return elements, texts


def drawing_differences(plain, hostile, texts, place):
    """Of a drawing, whose ticks and lines make room for the width of its texts."""
    elements, words = kinds(plain)
    found, found_words = kinds(hostile)
    if found - elements:
        return [f"{place}: found {found - elements}"]
    if found_words != {expected(word, texts) for word in words}:
        return [f"{place}: expected {words}, found {found_words}"]
    return []


def differences(plain, hostile, texts, place="html"):
    """Where the hostile page is not the plain one with other texts."""
    if isinstance(plain, str):
        # Texts that hold no word may be sizes and places of what is drawn, which follow the width of texts.
        if WORD.search(plain) and hostile != expected(plain, texts):
            return [f"{place}: expected {expected(plain, texts)!r}, found {hostile!r}"]
        return []
    if type(plain) is not type(hostile):
        return [f"{place}: expected {str(plain)[:80]}, found {str(hostile)[:80]}"]
    if isinstance(plain, dict):
        keys = {expected(key, texts): key for key in plain}
        if set(keys) != set(hostile):
            return [f"{place}: expected {sorted(keys)}, found {sorted(hostile)}"]
        if "tag" in plain:
            place += "/" + plain["tag"]
            if plain["tag"] != hostile["tag"]:
                return [f"{place}: found the element {hostile['tag']}"]
            if plain["tag"] == "svg":
                return drawing_differences(plain, hostile, texts, place)
        return [fault for key in keys for fault in differences(plain[keys[key]], hostile[key], texts, place)]
    if isinstance(plain, list):
        if len(plain) != len(hostile):
            return [f"{place}: expected {len(plain)} nodes, found {len(hostile)}"]
        return [fault for one, other in zip(plain, hostile) for fault in differences(one, other, texts, place)]
    return []


def parsed(files):
    done = subprocess.run(["node", os.path.join(HERE, "pages.cjs"), *files], capture_output=True, text=True, timeout=600,
                          env=dict(os.environ, NODE_PATH=os.path.join(SOURCE_DIR, "node_modules")))
    if done.returncode != 0:
        raise AssertionError("pages.cjs: " + done.stderr)
    return [json.loads(line) for line in done.stdout.split("\n") if line]


def words_in(node):
    if isinstance(node, str):
        return set(WORD.findall(node))
    items = [*node.keys(), *node.values()] if isinstance(node, dict) else node if isinstance(node, list) else []
    return set().union(*map(words_in, items)) if items else set()


def work(part, thorough):
    missing = [name for name in ("node", "chromium") if shutil.which(name) is None]
    if not os.path.isdir(os.path.join(SOURCE_DIR, "node_modules/playwright-core")):
        missing.append("playwright-core (npm ci in the source folder)")
    if missing:
        part.require(not thorough, "pages cannot be parsed without " + ", ".join(missing))
        part.note("Skipped without " + ", ".join(missing))
        return
    chance = random.Random(SEED)
    rounds = [PIECES]
    for _ in range(30 if thorough else 2):
        mixed = ["".join(chance.choices(PIECES, k=chance.randint(1, 8))) for _ in range(150)]
        rounds.append([text.replace("; ", ";") for text in mixed])  # which parts a run's message in two
    with tempfile.TemporaryDirectory(prefix="grouser_pages_") as home:
        whole = os.path.join(home, "whole")
        os.mkdir(whole)
        bushing = os.path.join(DATA, "bushings/m113.json")
        run("simulate", os.path.join(DATA, "scenarios/m113.json"), "-o", "run", "--set", "duration_s=0.2", "--set",
            "assembly.settle_time_s=2.6", cwd=whole)
        run("rig", os.path.join(DATA, "rig/protocol/rig.json"), "--bushing", bushing, "-o", "rig", cwd=whole)
        run("identify", "rig/rig.json", "-o", "fit", cwd=whole)
        plain_pages = parsed(pages_of(home, whole, None)[0])
        placed, pages = set(), 0
        for number, hostile in enumerate(rounds):
            files, texts = pages_of(home, whole, hostile)
            for plain, page in zip(plain_pages, parsed(files), strict=True):
                faults = page["wrong"] + differences(plain["tree"], page["tree"], texts)
                part.require(not faults, f"round {number}, {os.path.basename(page['file'])}: " + "; ".join(faults[:5]))
                part.require(page["foreign"] == plain["foreign"] == 0, f"round {number}: {page['foreign']} foreign elements")
                placed |= words_in(plain["tree"])
                pages += 1
    part.require(len(placed) > 50, f"expected more than 50 places, found {len(placed)}")
    part.row("pages with hostile text in every free place, parsed by Chromium beside the same page in plain words", pages,
             "same elements, every text letter by letter, no script of it run, nothing asked for")
    part.row("places of a page that a file can fill with free text", len(placed), "filled in each round")
    part.row("hostile texts", sum(map(len, rounds)), "markup, templates, line separators, addresses, alone and mixed at random")


if __name__ == "__main__":
    main("pages", "Escaping, by parsing the pages", work)
