#!/usr/bin/python3
"""Every name in the first table of doc/notation.md is there: keys in doc/input.md, names of files in the pages on them, names of the
code in src/.

usage: notation.py ROOT
"""
import pathlib
import re
import sys


def cells(text):
    """(keys, names in files, names in code) of the rows of the first table."""
    rows = [line for line in text.split("## Terms")[0].splitlines() if line.startswith("| ")][1:]
    for row in rows:
        _, _, _, _, key, file, code, _, _ = row.split("|")
        yield [re.findall("`([^`]+)`", cell) for cell in (key, file, code)]


def keys_of(text):
    """Paths of the keys in the generated part of doc/input.md."""
    table, found = "", set()
    for line in text.split("input/keys.cpp: begin")[1].splitlines():
        if head := re.match(r"### `\[([\w.]+)\]`", line):
            table = head[1] + "."
            found.add(head[1])
        elif row := re.match(r"\| `(\w+)` \|", line):
            found.add(table + row[1])
    return found


def main():
    root = pathlib.Path(sys.argv[1])
    keys = keys_of((root / "doc" / "input.md").read_text())
    files = (root / "doc" / "file_format.md").read_text() + (root / "doc" / "analyze.md").read_text()
    code = "\n".join(path.read_text() for path in (root / "src").rglob("*.hpp"))
    rows = list(cells((root / "doc" / "notation.md").read_text()))
    missing = [f"no key {name}" for row in rows for name in row[0] if name not in keys]
    missing += [f"no name {name} in files" for row in rows for name in row[1] if not re.search(rf"\b{name}\b", files)]
    missing += [f"no name {name} in src" for row in rows for name in row[2] if not re.search(rf"\b{name}\b", code)]
    print("\n".join(missing) or f"{len(rows)} symbols")
    return 1 if missing or len(rows) < 30 else 0


if __name__ == "__main__":
    sys.exit(main())
