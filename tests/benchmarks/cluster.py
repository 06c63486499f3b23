#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""cluster.py FOLDER --ibr IBR --lab IBR_LAB [--photographs 60] [--size 512x512] [--workers 2]
                  [--fresh] [--option WORD ...]

Builds a generated court in steps by Snakemake (examples/cluster), and in one process, and compares the scenes byte for
byte. One step is killed half way. Exit code 77 without snakemake. Prints time, bytes and memory of the steps. FOLDER keeps photographs and scenes: a
second call builds only what is missing.
"""
import argparse
import filecmp
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

CLUSTER = pathlib.Path(__file__).resolve().parents[2] / "examples/cluster"
CACHE = ".build"


def children(pid):
    """Returns the processes below a process, with their command lines."""
    found = []
    for child in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        for number in child.read_text().split():
            try:
                line = pathlib.Path(f"/proc/{number}/cmdline").read_bytes().decode().split("\0")
            except OSError:
                continue
            found += [(int(number), line), *children(number)]
    return found


def kill_one(process, kind, seconds):
    """Kills the first step of a kind that has run for some time. Returns the step's name; None if all steps ended."""
    since = {}
    while process.poll() is None:
        for pid, line in children(process.pid):
            name = line[line.index("--step") + 1] if "--step" in line and "shell" not in line[0] else ""
            if name.startswith(kind) and not line[0].endswith("sh"):
                if time.monotonic() - since.setdefault(pid, time.monotonic()) > seconds:
                    os.kill(pid, signal.SIGKILL)
                    return name
        time.sleep(0.05)
    return None


def files_of(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*")
            if path.is_file() and CACHE not in path.relative_to(folder).parts}


def differences(one, other):
    a, b = files_of(one), files_of(other)
    return sorted(a ^ b) + sorted(name for name in a & b if not filecmp.cmp(one / name, other / name, shallow=False))


def kind_of(step):
    return re.sub(r"-\d+$", "", step)


def usage_of(reports, steps):
    """Returns rows (kind, steps, processor s, predicted s, read bytes, written bytes, max memory, predicted memory)."""
    rows = {}
    for step in steps:
        usage = json.loads((reports / f"{step['name']}.json").read_text())
        usage = usage.get("usage", usage)
        row = rows.setdefault(kind_of(step["name"]), [0, 0, 0, 0, 0, 0, 0])
        for column, value in enumerate((1, usage["processorSeconds"], step["seconds"], usage["readBytes"],
                                        usage["writtenBytes"])):
            row[column] += value
        row[5] = max(row[5], usage["memory"])
        row[6] = max(row[6], step["memory"])
    return [(kind, *row) for kind, row in rows.items()]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--ibr", required=True, type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("--lab", required=True, type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("--photographs", type=int, default=60)
    parser.add_argument("--size", default="512x512")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--option", nargs="*", default=[], help="options of ibr build, with + for -: ++depth fast")
    parser.add_argument("--fresh", action="store_true", help="delete FOLDER first")
    parser.add_argument("--kill-after", type=float, default=1.0, metavar="S", help="age of the depth step to kill, s")
    parser.add_argument("--no-comparison", action="store_true", help="do not build in one process")
    given = parser.parse_args()
    options = [re.sub(r"^\++", lambda plus: "-" * len(plus[0]), word) for word in given.option]
    if not shutil.which("snakemake"):
        print("skipped: snakemake is not installed")
        sys.exit(77)
    folder = given.folder.resolve()
    if given.fresh:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    court, one, scene, reports = (folder / name for name in ("court", "one", "scene", "reports"))
    if not (court / "sparse/points3D.txt").exists():
        subprocess.run([given.lab, "synth", "court", "-o", court, "--photographs", str(given.photographs), "--size",
                        given.size, "-q"], check=True)
    build = [given.ibr, "build", court / "images", *options]

    start = time.monotonic()
    subprocess.run([*build, "-o", scene, "--steps", "-q", "--json", folder / "steps.json"], check=True)
    steps = json.loads((folder / "steps.json").read_text())["steps"]
    print(f"{len(steps)} steps listed in {time.monotonic() - start:.1f} s", flush=True)
    start = time.monotonic()
    with open(folder / "snakemake.log", "w") as log:
        process = subprocess.Popen(
            ["snakemake", "-s", CLUSTER / "Snakefile", "--profile", CLUSTER / "profiles/local", "--cores",
             str(given.workers), "--config", "steps=steps.json", f"ibr={given.ibr}"],
            cwd=folder, stdout=log, stderr=log)
        print("killed half way:", kill_one(process, "depth", given.kill_after), flush=True)
        code = process.wait()
    print(f"Snakemake ended with code {code} after {time.monotonic() - start:.0f} s", flush=True)
    if code:
        sys.exit(f"see {folder / 'snakemake.log'}")

    print(f"{'kind':12} {'steps':>5} {'cpu s':>8} {'predicted':>9} {'read MB':>9} {'written MB':>10} {'memory MiB':>10} "
          f"{'predicted':>9}")
    total = [0.0] * 5
    for kind, count, seconds, predicted, read, written, memory, predicted_memory in usage_of(reports, steps):
        print(f"{kind:12} {count:5} {seconds:8.1f} {predicted:9.1f} {read / 1e6:9.1f} {written / 1e6:10.1f} "
              f"{memory / 2**20:10.0f} {predicted_memory / 2**20:9.0f}")
        for column, value in enumerate((count, seconds, predicted, read / 1e6, written / 1e6)):
            total[column] += value
    print("{:12} {:5.0f} {:8.1f} {:9.1f} {:9.1f} {:10.1f}".format("all", *total), flush=True)

    if given.no_comparison:
        return
    if not (one / "scene.gltf").exists():
        start = time.monotonic()
        subprocess.run([*build, "-o", one, "--threads", str(given.workers), "-q"], check=True)
        print(f"one process: {time.monotonic() - start:.0f} s on {given.workers} threads")
    different = differences(one, scene)
    print(f"{len(files_of(scene))} files; different from the one-process build: {different or 'none'}")
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
