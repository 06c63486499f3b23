#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the test names on documentation pages against the tags of test cases.

A row `| T4 | … | tests |` of libibr/docs/numerics.md or promises.md names test cases in its last column, in backquotes:
every test case with the tag [T4], and no other. With --write the last columns are filled in from the tags.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = {
    "numerics.md": [f"T{i}" for i in range(1, 27)] + [f"N{i}" for i in range(1, 17)],
    "promises.md": [f"P{i}" for i in range(1, 13)],
}
CASE = re.compile(r'TEST_CASE\(\s*"((?:[^"\\]|\\.)*)",\s*"([^"]*)"\s*\)')
ROW = re.compile(r"^\| ([TNP]\d+) \|(.*)\|([^|]*)\|$")


def tests():
    """Returns, by tag, (name, file) of the test cases with this tag."""
    found = {}
    for file in sorted(ROOT.glob("tests/**/*.cpp")):
        for name, tags in CASE.findall(file.read_text(encoding="utf-8")):
            for tag in re.findall(r"\[([TNP]\d+)\]", tags):
                found.setdefault(tag, []).append((name, str(file.relative_to(ROOT))))
    return found


def column(cases):
    """Returns the last column: the number of tests, and a folded list of their names by file."""
    files = {}
    for name, file in cases:
        files.setdefault(file, []).append(f"`{name}`")
    names = "<br>".join(f"[{pathlib.Path(f).stem}](../../{f}): " + "; ".join(n) for f, n in files.items())
    summary = "1 test" if len(cases) == 1 else f"{len(cases)} tests"
    return f"<details><summary>{summary}</summary>{names}</details>"


def main():
    found, faults = tests(), []
    for page, ids in PAGES.items():
        path = ROOT / "libibr/docs" / page
        seen, lines = [], []
        for line in path.read_text(encoding="utf-8").splitlines():
            row = ROW.match(line)
            if row:
                ident, cases = row.group(1), found.get(row.group(1), [])
                seen.append(ident)
                if "--write" in sys.argv:
                    line = f"| {ident} |{row.group(2)}| {column(cases)} |"
                elif not cases:
                    faults.append(f"{page}: no test case has the tag [{ident}]")
                elif row.group(3).strip() != column(cases):
                    faults.append(f"{page}: {ident} names other test cases than those with the tag [{ident}]")
            lines.append(line)
        if seen != ids:
            faults.append(f"{page}: has rows {', '.join(seen)}; expected {ids[0]} to {ids[-1]}")
        if "--write" in sys.argv:
            path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    for tag in set(found) - {i for ids in PAGES.values() for i in ids}:
        faults.append(f"{found[tag][0][1]}: the tag [{tag}] is on no page")
    for fault in faults:
        print(fault, "(tests/proofs.py --write fills in the pages)", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
