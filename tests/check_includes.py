#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks every #include of the library and its programs against the table of rooms in libibr/ARCHITECTURE.md.

check_includes.py [ROOT]: a room is a folder of sources. Its row is `| room | holds | may include | papers |`. The third
column names, in backquotes, rooms and guarded libraries that the room's files may include and its target may link.

Exit code 1 if
  - an include or a link is not allowed
  - a row of a program or of the Python packages names a room that is internal to the library
  - a room has no row, or a row has no room
  - rows form a cycle
  - a folder has too many sources
  - CGAL is in two rooms
"""
import pathlib
import re
import sys

PAGE = "libibr/ARCHITECTURE.md"
INCLUDE_FOLDERS = ("libibr/src", "libibr/include", "libibr/python", "apps", "shaders")  # in the order of the search
GUARDED = ("CGAL", "opencv2", "ceres", "vulkan", "GLFW", "openxr", "nlohmann", "CLI", "openssl", "imgui", "pybind11",
           "libheif", "libraw", "webp", "pugixml")
SINGLE_ROOM_LIBRARY = "<CGAL>"  # only one room may include it: binaries that link CGAL are under the GPL
PROGRAM_ROOMS = ("ibr", "ibr/author", "base", "base/vulkan", "io", "shaders")  # library rooms that programs may include
PYTHON_ROOMS = ("ibr", "ibr/author")  # library rooms that the Python packages may include
MAX_SOURCES = 45  # files per folder
SUFFIXES = (".h", ".cpp", ".c")
INCLUDE = re.compile(r'\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')
LAYER = re.compile(r"ibr_layer\(([^)]*)\)")
HEADER = "| room | holds | may include | papers |"


def room_of(path):
    """Returns a file's room: author/match for `libibr/src/author/match/match.h`, python/runtime for
    `libibr/python/runtime/bind.h`, apps/window for `apps/window/window.h`."""
    if path.startswith("shaders/"):
        return "shaders"
    folder = path.rpartition("/")[0]
    for prefix in ("libibr/src/", "libibr/include/", "libibr/"):
        folder = folder.removeprefix(prefix)
    return folder


def rows_of(text):
    """Returns (line, room, allowed includes) of each row; the set is None if the number of columns is wrong."""
    rows, inside = [], False
    for number, line in enumerate(text.splitlines(), 1):
        if line == HEADER:
            inside = True
        elif not line.startswith("|"):
            inside = False
        elif inside and not line.startswith("|---"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            rows.append((number, cells[0].strip("`"), set(re.findall(r"`([^`]+)`", cells[2])) if len(cells) == 4 else None))
    return rows


def guarded(include):
    """Returns the guarded library of a system header, or None."""
    name = include.removeprefix("backends/")
    for library in GUARDED:
        if name.startswith(library + "/") or library in ("imgui", "pugixml") and name.startswith(library):
            return f"<{library}>"
    return None


def targets_of(rooms):
    """Returns the rooms of each CMake target: `ibr_gpu` has all rooms below gpu, `ibr_passes` has render/passes."""
    targets = {}
    for room in rooms:
        targets[f"ibr_{room.replace('/', '_')}"] = {room}
        if room.startswith("render/"):
            targets[f"ibr_{room.removeprefix('render/')}"] = {room}
    for group in ("gpu", "author"):
        targets[f"ibr_{group}"] = {room for room in rooms if room.startswith(group + "/")}
    return targets


def cycle_of(allowed):
    """Returns a list of rooms whose rows form a cycle, or None."""
    done = set()

    def visit(room, path):
        if room in path:
            return path[path.index(room):] + [room]
        if room in done:
            return None
        for other in sorted(allowed.get(room, ())):
            found = other in allowed and visit(other, path + [room])
            if found:
                return found
        done.add(room)
        return None

    for room in sorted(allowed):
        found = visit(room, [])
        if found:
            return found
    return None


def check(root):
    faults, allowed = [], {}
    for line, room, includes in rows_of((root / PAGE).read_text(encoding="utf-8")):
        where = f"{PAGE}:{line}: "
        if includes is None:
            faults.append(where + f"the row of {room} must have four columns")
        elif room in allowed:
            faults.append(where + f"{room} has two rows")
        allowed[room] = includes or set()
    if not allowed:
        faults.append(f"{PAGE}: the table of rooms is missing")

    sources = {}
    for folder in INCLUDE_FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and (path.suffix in SUFFIXES or folder == "shaders"):
                sources[path.relative_to(root).as_posix()] = path
    folders = {}
    for name in sources:
        if not name.startswith("shaders/"):
            folders.setdefault(name.rpartition("/")[0], []).append(name)
    for folder, names in folders.items():
        if room_of(names[0]) not in allowed:
            faults.append(f"{folder}: the room {room_of(names[0])} has no row in {PAGE}")
        if len(names) > MAX_SOURCES:
            faults.append(f"{folder}: {len(names)} sources, at most {MAX_SOURCES} are allowed; split the room")
    rooms = {room_of(name) for name in sources}
    for room, includes in allowed.items():
        if room not in rooms:
            faults.append(f"{PAGE}: the row of {room} has no folder of sources")
        for other in sorted(includes):
            if other not in allowed and other.strip("<>") not in GUARDED:
                faults.append(f"{PAGE}: the row of {room} names {other}, which is neither a room nor a guarded library")
        if room.startswith("python/"):
            for other in sorted(includes):
                if other in allowed and not other.startswith("python/") and other not in PYTHON_ROOMS:
                    faults.append(f"{PAGE}: the row of {room} names {other}; the Python packages use the public headers")
        if room.startswith("apps/"):
            for other in sorted(includes):
                if other in allowed and not other.startswith("apps/") and other not in PROGRAM_ROOMS and not (
                        other == "ibr/lab" and room.startswith("apps/lab")):
                    faults.append(f"{PAGE}: the row of {room} names {other}; programs use the public headers; allowed "
                                  f"rooms of the library are {', '.join(PROGRAM_ROOMS)}")
    users = sorted(room for room, includes in allowed.items() if SINGLE_ROOM_LIBRARY in includes)
    if len(users) > 1:
        faults.append(f"{PAGE}: {SINGLE_ROOM_LIBRARY} is allowed in {', '.join(users)}; only one room may have it")
    cycle = cycle_of(allowed)
    if cycle:
        faults.append(f"{PAGE}: the rows form a cycle: {' -> '.join(cycle)}")

    for name, path in sources.items():
        room = room_of(name)
        if room == "shaders" or room not in allowed:
            continue
        for line, text in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found = INCLUDE.match(text)
            if not found:
                continue
            include = found[1] or found[2]
            if found[2]:
                other = guarded(include)
                if other is None or other in allowed[room]:
                    continue
            else:
                target = next((f"{f}/{include}" for f in INCLUDE_FOLDERS if f"{f}/{include}" in sources), None)
                if target is None and include.startswith("shaders/"):  # generated from a shader
                    target = include
                if target is None:
                    faults.append(f'{name}:{line}: "{include}" is in none of {", ".join(INCLUDE_FOLDERS)}')
                    continue
                other = room_of(target)
                if other == room or other in allowed[room]:
                    continue
            faults.append(f"{name}:{line}: {room} may not include {other} ({include}): its row in {PAGE} does not name it")
    targets = targets_of(allowed)
    for path in sorted((root / "libibr/src").rglob("CMakeLists.txt")):
        name = path.relative_to(root).as_posix()
        room = room_of(name)
        for words in LAYER.findall(path.read_text(encoding="utf-8")):
            for linked in words.split()[1:]:
                for other in sorted(targets.get(linked, set()) - allowed.get(room, set()) - {room}):
                    faults.append(f"{name}: {room} may not link {linked}: its row in {PAGE} does not name {other}")
    return faults


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    faults = check(root)
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
