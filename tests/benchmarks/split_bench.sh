#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Benchmark that splits a panorama of 8192×4096 px into six faces of 105 degrees each, and prints a table. Compares:
#   ibr split
#   OpenCV's remap, bilinear, with and without the computation of its maps
#   ffmpeg's v360, bilinear; the second of two frames reuses the maps of the first
# Values are CPU seconds, the minimum of three runs. Programs run in turn, so that load affects all equally.
#   sh tests/benchmarks/split_bench.sh build/release/apps/batch/ibr
# Needs ffmpeg, and python3 with OpenCV and NumPy (PYTHON names another interpreter).
set -eu
program=$(realpath "$1")
python=${PYTHON:-python3}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$python" - <<'END'
import cv2, numpy
noise = numpy.random.default_rng(1).integers(0, 256, (512, 1024, 3)).astype(numpy.uint8)
cv2.imwrite("pano.png", cv2.resize(noise, (8192, 4096), interpolation=cv2.INTER_CUBIC))
END
cat > run.py <<'END'
import json, math, os, resource, subprocess, sys, time
import cv2, numpy

program, size, fov = sys.argv[1], 3398, 105
cv2.setNumThreads(1)
faces = [(0, 0), (90, 0), (180, 0), (-90, 0), (0, 90), (0, -90)]  # yaw, pitch in degrees

def ibr_split():
    subprocess.run([program, "split", "pano.png", "-o", "faces", "--threads", "1", "--format", "jpg", "--json",
                    "report.json", "-q"],
                   check=True, stdout=subprocess.DEVNULL)
    return json.load(open("report.json"))["sampleSeconds"]

def remap():
    """Returns CPU seconds with and without the computation of maps."""
    image = cv2.imread("pano.png")
    height, width = image.shape[:2]
    start = time.process_time()
    image = cv2.copyMakeBorder(image, 1, 1, 1, 1, cv2.BORDER_WRAP)
    remap_only = 0
    for yaw, pitch in faces:
        focal = size / 2 / math.tan(math.radians(fov / 2))
        at = (numpy.arange(size, dtype=numpy.float32) + 0.5 - size / 2) / focal
        x, y = numpy.meshgrid(at, -at)
        cy, sy, cp, sp = (f(math.radians(a)) for a in (yaw, pitch) for f in (math.cos, math.sin))
        up, ahead = y * cp + sp, cp - y * sp
        right, ahead = x * cy + ahead * sy, ahead * cy - x * sy
        u = cv2.phase(ahead, right)
        u = numpy.where(u > math.pi, u - 2 * math.pi, u) * (width / 2 / math.pi) + (width / 2 + 0.5)
        v = (height / 2 + 0.5) - numpy.arctan2(up, cv2.magnitude(right, ahead)) * (height / math.pi)
        fixed = cv2.convertMaps(u, v.astype(numpy.float32), cv2.CV_16SC2)
        before = time.process_time()
        cv2.remap(image, fixed[0], fixed[1], cv2.INTER_LINEAR)
        remap_only += time.process_time() - before
    return time.process_time() - start, remap_only

def v360(frames):
    seconds = []
    for yaw, pitch in faces:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(["ffmpeg", "-v", "error", "-threads", "1", "-f", "rawvideo", "-pix_fmt", "gbrp", "-s",
                        "8192x4096", "-i", f"frames{frames}.raw", "-filter_threads", "1", "-vf",
                        f"v360=e:flat:h_fov={fov}:v_fov={fov}:yaw={yaw}:pitch={pitch}:w={size}:h={size}:interp=line",
                        "-f", "null", "-"], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds.append(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    return sum(seconds)

for frames in (1, 2):
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-loop", "1", "-i", "pano.png", "-frames:v", str(frames), "-f",
                    "rawvideo", "-pix_fmt", "gbrp", f"frames{frames}.raw"], check=True)
rows = []
for run in range(3):
    with_maps, remap_only = remap()
    first, both = v360(1), v360(2)
    rows.append((ibr_split(), with_maps, remap_only, first, both - first))
minima = [min(column) for column in zip(*rows)]
names = ["ibr split", "OpenCV remap", "  without maps", "v360, first frame", "  further frames"]
for name, seconds in zip(names, minima):
    print(f"{name:18} {seconds:6.2f} s")
END
"$python" run.py "$program"
