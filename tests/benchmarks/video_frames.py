#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares a scene of frames that `ibr build` chooses from a video with a scene of as many frames evenly spaced in time.
The video is generated (`ibr-lab synth walk`), so that the poses of all frames and which of them are blurred are known.
Both scenes get the exact poses, and are compared with the same sharp views. Takes half an hour on two cores.

  python3 tests/benchmarks/video_frames.py build/release/apps out

APPS is the folder with batch/ibr and lab/ibr-lab. Results of an earlier run in OUT are reused. Needs ffmpeg.
"""
import json
import pathlib
import re
import subprocess
import sys

FRAME = re.compile(r"walk_(\d+)\.jpg$")
MAX_TERMS = 60  # ffmpeg's expressions may have 100


def run(log, *command):
    with open(log, "w") as output:
        subprocess.run([str(word) for word in command], check=True, stdout=output, stderr=subprocess.STDOUT)


def cut(video, numbers, folder):
    """Writes frames of the video as PNG files with the names of `ibr build`."""
    folder.mkdir(parents=True, exist_ok=True)
    for first in range(0, len(numbers), MAX_TERMS):
        part = numbers[first:first + MAX_TERMS]
        select = "+".join(f"eq(n\\,{number})" for number in part)
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", video, "-fps_mode", "passthrough", "-vf",
                        f"select={select}", "-start_number", "0", folder / "part_%03d.png"], check=True)
        for place, number in enumerate(part):
            (folder / f"part_{place:03d}.png").rename(folder / f"walk_{number:06d}.png")


def model_of(transforms, numbers, file):
    """Writes the poses of some frames, which are PNG files."""
    frames = [dict(transforms["frames"][number], file_path=f"walk_{number:06d}.png") for number in numbers]
    file.write_text(json.dumps(dict(transforms, frames=frames)))


def main(apps, out):
    ibr, lab, walk = apps / "batch/ibr", apps / "lab/ibr-lab", out / "walk"
    out.mkdir(parents=True, exist_ok=True)
    if not (walk / "walk.json").exists():
        print("generating the walk", flush=True)
        run(out / "walk.log", lab, "synth", "walk", "-o", walk)
    facts = json.loads((walk / "walk.json").read_text())
    transforms = json.loads((walk / "transforms.json").read_text())
    print("choosing frames", flush=True)
    run(out / "choice.log", ibr, "build", walk / "walk.mp4", "--model", walk / "transforms.json", "-o", out / "choice",
        "--dry-run")
    chosen = sorted(int(FRAME.search(path.name)[1]) for path in (out / "choice/.photographs").rglob("walk_*.jpg"))
    step = facts["frames"] / len(chosen)
    even = [int((place + 0.5) * step) for place in range(len(chosen))]
    print(f"| {len(chosen)} of {facts['frames']} frames | blurred | PSNR, dB | SSIM | FLIP |\n|---|---|---|---|---|",
          flush=True)
    for name, numbers in (("chosen", chosen), ("evenly spaced", even)):
        folder = out / name.split()[0]
        result = folder / "eval.json"
        if not result.exists():
            cut(walk / "walk.mp4", numbers, folder / "photographs")
            model_of(transforms, numbers, folder / "transforms.json")
            run(folder / "build.log", ibr, "build", folder / "photographs", "--model", folder / "transforms.json", "-o",
                folder / "scene", "--refine-poses", "off")
            run(folder / "eval.log", ibr, "eval", folder / "scene", "--truth", walk / "truth", "--json", result)
        mean = json.loads(result.read_text())["mean"]
        blurred = len(set(numbers) & set(facts["blurred"]))
        print(f"| {name} | {blurred} | {mean['psnr']:.2f} | {mean['ssim']:.3f} | {mean['flip']:.3f} |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
