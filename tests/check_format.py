#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the format of C and C++ files against .clang-format with clang-format 14. Headers in the folder shaders are
left out, because GLSL includes them too.

With --write the files are formatted. Exit code 77 if clang-format 14 is missing.
"""
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ("apps", "examples", "libibr", "tests")
SUFFIXES = (".h", ".cpp", ".c")


def clang_format():
    for name in ("clang-format-14", "clang-format"):
        found = shutil.which(name)
        if found:
            version = subprocess.run([found, "--version"], check=True, capture_output=True, text=True).stdout
            if re.search(r"version 14\.", version):
                return found
    return None


def main():
    program = clang_format()
    if program is None:
        print("clang-format 14 is missing (Debian: clang-format-14)", file=sys.stderr)
        return 77
    files = sorted(str(path.relative_to(ROOT)) for folder in FOLDERS for path in (ROOT / folder).rglob("*")
                   if path.suffix in SUFFIXES and path.is_file())
    mode = ["-i"] if "--write" in sys.argv else ["--dry-run", "-Werror"]
    status = 0
    for first in range(0, len(files), 100):
        status |= subprocess.run([program, *mode, *files[first:first + 100]], cwd=ROOT).returncode
    if status:
        print("to format the files: tests/check_format.py --write", file=sys.stderr)
    return 1 if status else 0


if __name__ == "__main__":
    sys.exit(main())
