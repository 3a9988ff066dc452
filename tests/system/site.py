#!/usr/bin/python3
"""The documentation as a site, opened from the disk in a real browser: formulas are typeset, wide tables scroll, search finds.

usage: site.py ROOT FOLDER
Exit code 77: Chromium is missing (scripts/setup.sh --report).
"""
import pathlib
import subprocess
import sys
import tempfile

import browser

# Formulas, as TeX, that must be on a page and be drawn.
FORMULAS = {"theory": [r"r^\ast = r_i", r"m^\ast = m_i", r"1/E^\ast = (1 - \nu^2) / E", r"2.87 \left[ \frac{m^{\ast 2}}{r^\ast E^{\ast 2} v} \right]^{1/5}",
                       r"d^\ast = 2 \xi \sqrt{2 E^\ast} \sqrt{m^\ast \sqrt{r^\ast \delta}}"],
            "howto_confinement": [r"M = K + \tfrac43 G"], "notation": [r"\sqrt{m^\ast \sqrt{r^\ast \delta}}"]}
# When MathJax is done: of each formula its TeX, what is wrong with it, and how wide and high it is drawn.
TYPESET = """new Promise(done => {
  const shape = one => document.getElementById(one.inputID + '-Frame').querySelector('svg').getBoundingClientRect();
  const all = () => done(MathJax.Hub.getAllJax().map(one => [one.originalText, one.texError ? one.texError.message : '', shape(one).width, shape(one).height]));
  const wait = () => window.MathJax && MathJax.Hub && MathJax.isReady ? MathJax.Hub.Queue(all) : setTimeout(wait, 20);
  wait();
})"""
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


def check_formulas(page, site):
    """All are typeset, from the disk, and the page is no wider by them."""
    for name, wanted in FORMULAS.items():
        page.open((site / f"{name}.html").as_uri())
        drawn = page.value(TYPESET)
        written = page.value("""document.querySelectorAll('script[type^="math/tex"]').length""")
        expect(len(drawn) == written, f"{name}.html: {len(drawn)} of {written} formulas are typeset")
        for formula in wanted:
            expect(any(formula in tex for tex, *_ in drawn), f"{name}.html has lost {formula}")
        for tex, wrong, width, height in drawn:
            expect(not wrong and width > 3.0 and height > 3.0, f"{name}.html: {tex} is drawn {width} x {height} {wrong}")
        left = page.value("[...document.querySelectorAll('article :not(script, style, code, pre)')].flatMap(one => [...one.childNodes]).filter(one => one.nodeType === 3 && /\\$|\\\\[a-z]{2}/.test(one.data)).map(one => one.data)")
        expect(not left, f"{name}.html has TeX as text: {left}")
        wide = page.value("document.documentElement.scrollWidth")
        expect(wide <= WIDTH, f"{name}.html is {wide} pixels wide in a window of {WIDTH}")
        fetched = [one for one in page.requests if not one.startswith(("file:", "data:"))]
        expect(not fetched, f"{name}.html asks for {fetched}")


def check(page, site):
    page.look(WIDTH)
    check_formulas(page, site)
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
    print("\n".join(problems) or "seven pages looked at")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
