#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants each fault of mutants.py into a copy of the sources, builds, and prints which test detects the fault.

    tests/mutants/run.py --copy build/mutants                 all faults: an hour and a half on two cores
    tests/mutants/run.py --copy build/mutants --only 4 12     faults with these numbers
    tests/mutants/run.py --copy build/mutants --list list.md  also writes the table to a Markdown file

A fault counts as seen only if the same test program passes without the fault. The mutant's own cases are run first. If
these cases pass, all cases of the program are run. Exit code 1 if more than one fault is not seen."""
import argparse
import contextlib
import functools
import pathlib
import re
import shutil
import subprocess
import sys

from mutants import MUTANTS

ROOT = pathlib.Path(__file__).resolve().parents[2]
TIMEOUT_SECONDS = 900  # limit of a test program; a program that hangs has detected the fault


def copy_sources(copy):
    """Copies the files that git tracks from the working tree. Unchanged files are not written, to avoid a rebuild."""
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for name in filter(None, files.split("\0")):
        here, there = ROOT / name, copy / name
        there.parent.mkdir(parents=True, exist_ok=True)
        if not there.exists() or here.read_bytes() != there.read_bytes():
            shutil.copy(here, there)


def build(copy, target):
    if not (copy / "build").exists():
        subprocess.run(["cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None",
                        "-DCMAKE_CXX_FLAGS=-O2"], cwd=copy, check=True, stdout=subprocess.DEVNULL)
    return subprocess.run(["ninja", "-C", "build", target], cwd=copy, capture_output=True, text=True)


def first_failure(copy, target, cases):
    """Returns the name of the first failing case, None if all cases pass, or '' if the program runs no case."""
    program = next(path for path in (copy / "build/tests").rglob(target) if path.is_file())
    command = [str(program), "-a", "-r", "xml"] + ([cases] if cases else [])
    try:
        run = subprocess.run(command, cwd=copy, capture_output=True, text=True, errors="replace",
                             timeout=TIMEOUT_SECONDS)
    except subprocess.TimeoutExpired:
        return "(timeout)"
    names = re.findall(r'<TestCase name="([^"]*)"', run.stdout)
    if run.returncode == 0:
        return None if names else ""
    return names[-1] if names else "(the program does not start)"


@contextlib.contextmanager
def planted(copy, edits):
    before = {}
    try:
        for name, old, new in edits:
            file = copy / name
            text = file.read_text()
            if text.count(old) != 1:
                raise SystemExit(f"{name}: contains a mutant's text {text.count(old)} times, not once:\n{old}")
            before.setdefault(file, text)
            file.write_text(text.replace(old, new))
        yield
    finally:
        for file, text in before.items():
            file.write_text(text)


@functools.cache
def failure_without(copy, target, cases):
    if build(copy, target).returncode != 0:
        raise SystemExit(f"{target}: does not build without a fault")
    return first_failure(copy, target, cases)


def try_mutant(copy, mutant):
    """Returns (seen, test that sees the fault or reason why none does)."""
    for cases in dict.fromkeys([mutant.cases, ""]):
        without = failure_without(copy, mutant.test, cases)
        if without == "":
            continue  # no such case
        if without is not None:
            return False, f"{mutant.test} fails without the fault: {without}"
        with planted(copy, mutant.edits):
            built = build(copy, mutant.test)
            if built.returncode != 0:
                return False, "does not build: " + next((l for l in built.stdout.splitlines() if "error" in l), "")
            failure = first_failure(copy, mutant.test, cases)
        if failure:
            return True, f"{mutant.test}: {failure}"
    return False, f"not seen by {mutant.test}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--copy", type=pathlib.Path, required=True,
                        help="folder for the copy and its build; later runs reuse it")
    parser.add_argument("--only", type=int, nargs="+", help="numbers of mutants, from 1")
    parser.add_argument("--list", type=pathlib.Path, help="write the table to this file")
    options = parser.parse_args()
    copy = options.copy.resolve()
    copy_sources(copy)
    rows, survived = [], 0
    for number, mutant in enumerate(MUTANTS, 1):
        if options.only and number not in options.only:
            continue
        seen, reason = try_mutant(copy, mutant)
        survived += not seen
        rows.append(f"| {number} | {mutant.name} | {'yes' if seen else 'NO'} | {reason} |")
        print(rows[-1], flush=True)
    if options.list:
        options.list.write_text("| | fault | seen | by |\n|---|---|---|---|\n" + "\n".join(rows) + "\n")
    print(f"{len(rows) - survived} of {len(rows)} seen")
    return 1 if survived > 1 else 0


if __name__ == "__main__":
    sys.exit(main())
