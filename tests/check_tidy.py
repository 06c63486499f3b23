#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy with the checks of .clang-tidy over sources of the library and its programs.

check_tidy.py BUILD [--all] [-j N]: BUILD contains compile_commands.json. Sources: the runtime (libibr/src without
author), with --all also author and apps. Precompiled headers are left out, so that a missing include is an error too.
Exit code 1 if a check finds a fault or a source does not compile, 77 if clang-tidy is not installed.
"""
import argparse
import json
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent
# clang 14 lacks parenthesised initialisation of aggregates (C++20), which emplace_back and make_unique use here.
FALSE_ERRORS = re.compile(r"construct_at|no matching constructor for initialization")
COMPILER = re.compile(r"(?:^|[/-])(?:c\+\+|g\+\+|clang\+\+)(?:-\d+)?$")


def without_precompiled_header(command):
    words, result = shlex.split(command), []
    for i, word in enumerate(words):
        if word.endswith("cmake_pch.hxx") or word in ("-Winvalid-pch", "-fpch-preprocess"):
            continue
        if word == "-include" and words[i + 1].endswith("cmake_pch.hxx"):
            continue
        result.append(word)
    first = next(i for i, word in enumerate(result) if COMPILER.search(word))  # after ccache and its environment
    return shlex.join(result[first:])


def is_checked(path, check_all):
    name = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else ""
    runtime = name.startswith("libibr/src/") and not name.startswith("libibr/src/author/")
    return name.endswith(".cpp") and (runtime or check_all and name.startswith(("libibr/src/", "apps/")))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--all", action="store_true", help="check author and apps too")
    parser.add_argument("-j", type=int, default=2, metavar="N", help="number of processes")
    options = parser.parse_args()
    tidy = shutil.which("clang-tidy-14") or shutil.which("clang-tidy")
    if not tidy:
        print("clang-tidy is not installed")
        return 77
    commands = {}
    for entry in json.loads((options.build / "compile_commands.json").read_text(encoding="utf-8")):
        path = pathlib.Path(entry["directory"], entry["file"]).resolve()
        if is_checked(path, options.all):
            commands[path] = entry | {"command": without_precompiled_header(entry["command"])}
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "compile_commands.json").write_text(json.dumps(list(commands.values())), encoding="utf-8")

        def check(path):
            run = subprocess.run([tidy, "-p", folder, "--quiet", "--extra-arg=-Wno-everything", path],
                                 capture_output=True, text=True)
            errors = [line for line in run.stdout.splitlines() if " error: " in line]
            if run.returncode and not errors:
                return [f"{path}: clang-tidy failed: {run.stderr.strip()[-200:]}"]
            return [line for line in errors if not FALSE_ERRORS.search(line)]

        with ThreadPoolExecutor(options.j) as pool:
            faults = sorted({fault for found in pool.map(check, commands) for fault in found})
    for fault in faults:
        print(fault.removeprefix(f"{ROOT}/"))
    print(f"clang-tidy: {len(commands)} sources, {len(faults)} faults")
    return 1 if faults or not commands else 0


if __name__ == "__main__":
    sys.exit(main())
