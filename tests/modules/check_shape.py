#!/usr/bin/env python3
"""Holds src/ of a checkout to its limits: lines of a function, lines of a module, no circle of includes.

usage: check_shape.py ROOT [--function 60] [--module 3000] [--expect FILE]

The lines of a function are those from its opening to its closing brace. With --expect, what is found must be the lines of FILE
(the test of this test).
"""
import argparse
import re
import sys
from pathlib import Path

NO_CODE = re.compile(r'^ *#[^\n]*|//[^\n]*|/\*.*?\*/|R"\((.*?)\)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\])+\'',
                     re.DOTALL | re.MULTILINE)
NO_FUNCTION = re.compile(r"\s*(template\s*<[^;]*>\s*)?(inline\s+)?(namespace|class|struct|enum|union|extern)\b")


def long_functions(name: str, text: str, limit: int) -> list[str]:
    """Blocks behind parentheses of more than `limit` lines; where one stands in another, both are told."""
    code = NO_CODE.sub(lambda found: "\n" * found.group().count("\n"), text)
    found, opened, start, line, head = [], [], 0, 1, ""
    for at, letter in enumerate(code):
        if letter in "{};":
            head = code[start:at]
            start = at + 1
        if letter == "{":
            opened.append((line, "(" in head and not NO_FUNCTION.match(head)))
        elif letter == "}":
            first, is_function = opened.pop()
            if is_function and line - first + 1 > limit:
                found.append(f"{name}:{first}: {line - first + 1} lines")
        line += letter == "\n"
    return found


def circles(includes: dict[str, list[str]]) -> list[str]:
    """Each circle once, from its first file in the order of the alphabet."""
    found, done = [], set()

    def follow(name: str, path: list[str]) -> None:
        if name in path:
            found.append(" -> ".join([*path[path.index(name):], name]))
        elif name not in done:
            for other in includes.get(name, []):
                follow(other, [*path, name])
            done.add(name)

    for name in sorted(includes):
        follow(name, [])
    return found


def violations(root: Path, function_limit: int, module_limit: int) -> tuple[list[str], int]:
    texts = {str(file.relative_to(root / "src")): file.read_text() for file in sorted((root / "src").rglob("*.[ch]pp"))}
    found, sizes = [], {}
    for name, text in texts.items():
        found += long_functions(name, text, function_limit)
        module = name.split("/")[0]
        sizes[module] = sizes.get(module, 0) + text.count("\n")
    found += [f"{module}: {size} lines" for module, size in sorted(sizes.items()) if size > module_limit]
    includes = {name: re.findall(r'^#include "([^"]*)"', text, re.MULTILINE) for name, text in texts.items()}
    return found + circles(includes), len(texts)


def main() -> int:
    reader = argparse.ArgumentParser()
    reader.add_argument("root", type=Path)
    reader.add_argument("--function", type=int, default=60)
    reader.add_argument("--module", type=int, default=3000)
    reader.add_argument("--expect", type=Path)
    given = reader.parse_args()
    found, count = violations(given.root, given.function, given.module)
    expected = given.expect.read_text().splitlines() if given.expect else []
    for line in found:
        if line not in expected:
            print(line)
    if given.expect:
        return 0 if found == expected else 1
    print(f"{count} files checked")
    return 1 if found or count < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
