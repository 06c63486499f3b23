#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures what each setting of `ibr build`, `ibr optimise`, `ibr htm build` and `ibr htm eval` costs and gains, and writes
libibr/docs/reference/measured.json, which the page of settings shows. Settings of rendering are measured by
libibr/docs/tradeoff.sh.

  python3 libibr/docs/reference/measure.py build/release/apps DATASETS OUT [--only "ibr build"] [--write]

One setting at a time differs from the defaults. Cost is the processor time of the command, relative to the defaults. Gain
is the difference of PSNR, and of other scores, of views that were held out or generated, for each scene. Results in OUT are reused.
Takes two hours on two cores.
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
PHOTOGRAPHS = HERE.parent.parent.parent / "examples/photographs"

# Values to compare with the default; "" is a flag.
VALUES = {
    "ibr build": {
        "--draft": [""], "--tracks": ["model", "own"], "--refine-poses": ["on"], "--strip-metadata": [""],
        "--movers": ["remove"], "--match-exposure": ["off"], "--vignetting": ["fit"], "--max-size": ["200"],
        "--texture": ["bc1", "bc7"], "--dimension": ["1", "2"], "--matcher": ["homographic", "flow"],
        "--triangle-filter": ["homogeneous"], "--no-backdrops": [""], "--depth": ["fast", "swept", "fine"],
        "--backdrop-spacing": ["4", "8", "16"], "--optimise": [""],
    },
    "ibr optimise": {
        "--method": ["cpu", "compute", "raster"], "--instances": ["--method compute --instances 16"],
        "--radius": ["--method compute --radius 2"], "--decay": ["--method compute --decay 0.8"],
        "--threshold": ["0.02"], "--definition": ["concatenated"], "--rigidity": ["0", "10"], "--epipolar": ["1"],
        "--levels": ["3"], "--escape": ["0", "24"], "--flip-edges": [""],
        "--flip-gain": ["--flip-edges --flip-gain 0.02"], "--insert-points": [""],
        "--insert-below": ["--insert-points --insert-below 0.8"], "--insert-gain": ["--insert-points --insert-gain 0.02"],
        "--prune": ["--method compute --prune"],
    },
    "ibr htm build": {
        "--match": ["device"], "--faces": ["2000"], "--adjust": ["0"], "--keep-shape": [""], "--measure": ["ncc"],
        "--radius": ["8"], "--later-radius": ["12"], "--min-texture": ["4"], "--smoothness": ["0"], "--complement-px": ["0", "2"],
        "--inconsistent-size": ["0"], "--inconsistent-difference": ["24"], "--inconsistent-share": ["0.02"],
        "--rounds": ["--faces 500 --rounds 1", "--faces 500 --rounds 3"], "--mean-difference": ["--faces 500 --mean-difference 4"],
        "--face-difference": ["--faces 500 --face-difference 8"], "--min-face": ["--faces 500 --min-face 1000"],
        "--max-faces": ["--faces 500 --rounds 3 --max-faces 600"], "--no-self-occluded": ["--faces 500 --no-self-occluded"],
        "--no-reject": [""], "--reject-difference": ["90"],
        "--reject-correlation": ["0.5"], "--alpha": ["0", "1"], "--gamma1": ["2", "30"], "--soft": ["0.5", "16"],
        "--max-size": ["256"],
    },
    "ibr htm eval": {"--gamma": ["10", "200"], "--weight-cut": ["0", "0.05"]},
}


class Failed(Exception):
    pass


class Bench:
    def __init__(self, apps, datasets, out):
        self.ibr, self.lab = apps / "batch/ibr", apps / "lab/ibr-lab"
        self.datasets, self.out = datasets, out

    def run(self, program, *words):
        """Returns the processor seconds of a command."""
        child = subprocess.Popen([program, *map(str, words), "-q"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        said = child.stderr.read().decode()
        _, status, usage = os.wait4(child.pid, 0)
        if status:
            raise Failed(f"{' '.join(map(str, words))}\n{said}")
        return usage.ru_utime + usage.ru_stime

    def mean_of(self, scene, truth, *words):
        result = self.out / "eval.json"
        self.run(self.ibr, "eval", scene, "--truth", truth, "--json", result, *words)
        mean = json.loads(result.read_text())["mean"]
        return {"psnr": mean["psnr"], "flip": mean["flip"]}

    def scenes(self):
        """Yields photographs, model, truth and held-out names of a generated court and a bundled lane."""
        court = self.out / "court"
        if not (court / "sparse").exists():
            self.run(self.lab, "synth", "court", "-o", court, "--photographs", 24, "--size", "320x240")
        yield "court", court / "images", court / "sparse", court / "truth", []
        lane = PHOTOGRAPHS / "lane"
        yield "lane", lane, lane / "sparse", lane, ["04.jpg", "08.jpg"]

    def build(self, extra):
        figures = {}
        for name, photographs, model, truth, held in self.scenes():
            words = ["build", photographs, "--model", model, "-o", self.out / "scene", "--cache", self.out / "cache"]
            if "--max-size" not in extra:
                words += ["--max-size", 400]
            words += extra + (["--exclude", *held] if held else [])
            for folder in ("scene", "cache"):
                subprocess.run(["rm", "-rf", self.out / folder], check=True)
            seconds = self.run(self.ibr, *words)
            views = ["--views", *held] if held else []
            figures[name] = {"cpu": seconds, **self.mean_of(self.out / "scene", truth, *views)}
        return figures

    def optimise(self, extra):
        figures = {}
        for name, photographs, model, truth, held in self.scenes():
            scene = self.out / f"{name}-built"
            if not (scene / "scene.gltf").exists():
                self.run(self.ibr, "build", photographs, "--model", model, "-o", scene, "--max-size", 400,
                         *(["--exclude", *held] if held else []))
            report = self.out / "optimise.json"
            subprocess.run(["rm", "-rf", self.out / "scene"], check=True)
            seconds = self.run(self.ibr, "optimise", scene, "-o", self.out / "scene", "--json", report, "--cells-only", 0, 1, 2,
                               3, *extra)
            mean = json.loads(report.read_text())["mean"]
            views = ["--views", *held] if held else []
            figures[name] = {"cpu": seconds, "ecc": mean["finalEcc"],
                             **self.mean_of(self.out / "scene", truth, "--composition", "cells", *views)}
        return figures

    def harmonise(self, extra, eval_extra=()):
        studio, model, result = self.datasets / "studio", self.out / "model", self.out / "htm.json"
        words = [] if "--max-size" in extra else ["--max-size", 400]
        seconds = self.run(self.ibr, "htm", "build", "--mesh", studio / "mesh_inexact.ply", "--model", studio / "sparse_noisy",
                           "--images", studio / "images", "--masks", studio / "masks", "-o", model, *words, *extra)
        self.run(self.ibr, "htm", "eval", model, "--truth", studio / "gt", "--json", result, *eval_extra)
        mean = json.loads(result.read_text())["mean"]["htm"]
        return {"studio": {"cpu": seconds, "psnr": mean["psnrCovered"], "ssim": mean["ssim"]}}

    def measure(self, command, extra):
        if command == "ibr build":
            return self.build(extra)
        if command == "ibr optimise":
            return self.optimise(extra)
        if command == "ibr htm build":
            return self.harmonise(extra)
        return self.harmonise([], extra)


def words_of(option, value):
    if value.startswith("--"):
        return value.split()
    return [option, value] if value else [option]


def compared(figures, base):
    """The ratio of processor times, as a mean over the scenes, and the differences of each scene."""
    logs = [math.log(figures[scene]["cpu"] / base[scene]["cpu"]) for scene in base]
    result = {"cpu": round(math.exp(sum(logs) / len(logs)), 2)}
    for name, digits in (("psnr", 2), ("flip", 3), ("ecc", 4), ("ssim", 4)):
        if name in figures[next(iter(base))]:
            result[name] = {scene: round(figures[scene][name] - base[scene][name], digits) for scene in base}
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("apps", type=pathlib.Path)
    parser.add_argument("datasets", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--only", choices=VALUES, help="measure the settings of this command only")
    parser.add_argument("--write", action="store_true", help="write measured.json")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    bench = Bench(options.apps.resolve(), options.datasets.resolve(), options.out.resolve())
    kept_file = options.out / "kept.json"
    kept = json.loads(kept_file.read_text()) if kept_file.exists() else {}

    def figures_of(command, words):
        key = " ".join([command, *words])
        if key not in kept:
            try:
                kept[key] = bench.measure(command, words)
            except Failed as failure:
                print(f"{key} failed: {failure}", file=sys.stderr)
                return None
            kept_file.write_text(json.dumps(kept, indent=1))
        return kept[key]

    measured_file = HERE / "measured.json"
    measured = json.loads(measured_file.read_text()) if measured_file.exists() else {}
    for command, settings in VALUES.items():
        if options.only not in (None, command):
            continue
        base = figures_of(command, [])
        measured.setdefault(command, {})
        for option, values in settings.items():
            rows = {}
            for value in values:
                words = words_of(option, value)
                reference = base
                if value.startswith("--"):  # compared with the same setting without this option
                    reference = figures_of(command, words[:words.index(option)])
                figures = figures_of(command, words)
                if figures:
                    rows[" ".join(words)] = compared(figures, reference)
            measured[command][option] = rows
            print(command, option, json.dumps(rows), flush=True)
            if options.write:
                measured_file.write_text(json.dumps(measured, indent=1) + "\n")


if __name__ == "__main__":
    main()
