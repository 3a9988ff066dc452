#!/usr/bin/python3
"""The documentation as a site, opened from the disk in a real browser: formulas are whole, wide tables scroll, search finds.

usage: site.py ROOT FOLDER
Exit code 77: Chromium is missing (scripts/setup.sh --report).
"""
import pathlib
import subprocess
import sys
import tempfile

import browser

FORMULAS = ["r* = r_i", "m* = m_i", "1/E* = (1 - nu^2) / E", "2.87 [m*^2 / (r* E*^2 v)]^(1/5)", "d* = 2 xi sqrt(2 E*) sqrt(m* sqrt(r* delta))"]
SEARCH = """(words => {
  const field = document.querySelector('.disk-search input');
  field.value = words;
  field.dispatchEvent(new Event('input'));
  return [...document.querySelectorAll('.disk-search a')].map(link => link.href);
})"""

# Of every table that is wider than a box around it, or than itself: what that box does with the rest.
WIDE = """[...document.querySelectorAll('.md-typeset table')].flatMap(table => {
  for (let box = table; box.tagName !== 'ARTICLE'; box = box.parentElement)
    if (box.scrollWidth > box.clientWidth) return [getComputedStyle(box).overflowX];
  return [];
})"""
WIDTH = 360   # of a telephone

problems = []


def expect(condition, words):
    if not condition:
        problems.append(words)


def check(page, site):
    page.look(WIDTH)
    page.open((site / "theory.html").as_uri())
    for formula in FORMULAS:
        expect(page.value(f"document.body.textContent.includes({formula!r})"), f"theory.html has lost {formula}")
    page.open((site / "performance.html").as_uri())
    wide = page.value("document.documentElement.scrollWidth")
    expect(wide <= WIDTH, f"performance.html is {wide} pixels wide in a window of {WIDTH}")
    boxes = page.value(WIDE)
    expect(len(boxes) > 5, "no table of performance.html is wider than its window: this test looks at nothing")
    expect(all(overflow == "auto" for overflow in boxes), f"a wide table cannot be scrolled: {boxes}")
    links = page.value(f"{SEARCH}('Fabric tensor')")
    expect(any(link.endswith("analyze.html") for link in links), f"a search for 'fabric tensor' finds {links}")
    page.look(WIDTH, dark=True)
    page.open((site / "theory.html").as_uri())
    ink, paper = (page.value(f"getComputedStyle(document.body).{what}.match(/[0-9]+/g).slice(0, 3).reduce((a, b) => a + +b, 0)") for what in ("color", "backgroundColor"))
    expect(paper < 250 < 300 < ink, f"in the dark the ink is {ink} and the paper {paper}, of 765")
    page.look(WIDTH)
    page.open((site / "index.html").as_uri())
    expect(page.value(f"{SEARCH}('no-such-word-anywhere')") == [], "a search for what is not there finds something")


def main():
    root, site = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    subprocess.run([root / "scripts" / "dev" / "site.sh", site], check=True)
    if browser.program() is None:
        print("skipped: Chromium is missing (scripts/setup.sh --report)")
        return 77
    with tempfile.TemporaryDirectory() as profile, browser.Browser(profile) as page:
        check(page, site)
    print("\n".join(problems) or "five pages looked at")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
