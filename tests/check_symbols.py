#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the symbols that libibr.so exports with cmake/debian/libibr0.symbols, Debian's list of them.

check_symbols.py LIBRARY [--write]: exit code 1 if they differ. --write replaces the list; a removed or changed symbol
of a released version needs a new SONAME.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIST = ROOT / "cmake/debian/libibr0.symbols"
HEADER = "libibr.so.0 libibr0 #MINVER#\n"


def exported(library):
    """Returns the demangled names of the defined dynamic symbols."""
    lines = subprocess.run(["nm", "--dynamic", "--defined-only", "--demangle", "--format=posix", library], check=True,
                           text=True, stdout=subprocess.PIPE).stdout.splitlines()
    # A posix line is `name type value [size]`; a demangled name contains spaces.
    return sorted({re.sub(r" [A-Za-z] [0-9a-f]+( [0-9a-f]+)?$", "", line) for line in lines})


def listed():
    versions = {}
    for line in LIST.read_text(encoding="utf-8").splitlines():
        found = re.fullmatch(r' \(c\+\+\)"(.+)@Base" (\S+)', line)
        if found:
            versions[found[1]] = found[2]
    return versions


def main():
    names = exported(sys.argv[1])
    known = listed() if LIST.exists() else {}
    if "--write" in sys.argv:
        version = re.search(r"#define IBR_VERSION_MAJOR (\d+)\n#define IBR_VERSION_MINOR (\d+)\n#define IBR_VERSION_PATCH (\d+)",
                            (ROOT / "libibr/include/ibr/version.h").read_text(encoding="utf-8"))
        version = ".".join(version.groups())
        LIST.write_text(HEADER + "".join(f' (c++)"{name}@Base" {known.get(name, version)}\n' for name in names),
                        encoding="utf-8")
        return 0
    faults = [f"{name}: exported, but not listed" for name in names if name not in known]
    faults += [f"{name}: listed, but not exported" for name in known if name not in names]
    faults += [f"{name}: not of namespace ibr" for name in names if "ibr::" not in name]
    for fault in faults:
        print(fault, file=sys.stderr)
    if faults:
        print(f"{LIST.relative_to(ROOT)}: {len(faults)} differences; see --write in tests/check_symbols.py", file=sys.stderr)
    print(f"{len(names)} symbols")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
