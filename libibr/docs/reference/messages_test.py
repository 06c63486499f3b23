#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every message on the page of troubleshooting is one that a source has."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent.parent
PAGE = ROOT / "libibr/docs/troubleshooting.md"


def literals():
    """All texts of the sources' string literals, with {…} as {}, one a line."""
    texts = []
    for folder in ("libibr/src", "libibr/include", "apps"):
        for file in sorted((ROOT / folder).rglob("*.[ch]*")):
            if file.suffix in (".cpp", ".h"):
                joined = re.sub(r'"\s*\n\s*"', "", file.read_text())
                texts += re.findall(r'"((?:[^"\\\n]|\\.)*)"', joined)
    return re.sub(r"\{[^{}]*\}", "{}", "\n".join(texts)).replace('\\"', '"')


def main():
    rows = re.findall(r"^\| `([^`]+)` \|", PAGE.read_text().partition("## What you may see")[0], re.MULTILINE)
    said = literals()
    missing = [row for row in rows if row not in said]
    for row in missing:
        print(f"{PAGE.name}: no source says: {row}", file=sys.stderr)
    print(f"{len(rows)} messages, {len(missing)} of them not found")
    return 1 if missing or len(rows) < 40 else 0


if __name__ == "__main__":
    sys.exit(main())
