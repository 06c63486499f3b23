# SPDX-License-Identifier: Apache-2.0
"""tradeoff_page.py tradeoff.py OUT SCENE: runs libibr/docs/tradeoff.py on a copy of the report in OUT/SCENE/report and
checks that the page has the measured values, that the exit code reports a beaten preset, and that local paths and large
images are refused. Exit code 77 without a report, that is, without a Vulkan device.
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

script, out, scene = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
if not (out / scene / "report" / "tradeoff.json").exists():
    print("skipped: no report, as there is no device")
    sys.exit(77)


def run_script(change, *options):
    """Runs the script after `change` has modified the report. Returns exit code, page, number of images and stderr."""
    with tempfile.TemporaryDirectory() as scratch:
        docs, report = pathlib.Path(scratch, "docs"), pathlib.Path(scratch, "out", scene, "report")
        docs.mkdir()
        (docs / "pictures").mkdir()
        for name in ("tradeoff.py", "tradeoff.md"):
            shutil.copy(script.parent / name, docs / name)
        shutil.copytree(out / scene / "report", report)
        data = json.loads((report / "tradeoff.json").read_text())
        # Replaces measured times by times proportional to the drawn triangles, so that the test is deterministic.
        for row in data["settings"]:
            if "failure" not in row:
                row["ms"]["median"] = 1 + sum(view["triangles"] for view in row["views"])
        data["command"] = "ibr tradeoff"
        change(data, report)
        (report / "tradeoff.json").write_text(json.dumps(data))
        command = [sys.executable, docs / "tradeoff.py", report.parents[1], *options]
        run = subprocess.run(command, capture_output=True, text=True)
        return run.returncode, (docs / "tradeoff.md").read_text(), len(list((docs / "pictures").iterdir())), run.stderr


def valid(data, report):
    for file in report.glob("*.svg"):  # the test's command contains folders of this machine
        file.write_text("<svg></svg>")


def beaten_preset(data, report):
    valid(data, report)
    for row in data["settings"]:
        if row["setting"] == "preset accurate":
            row["ms"]["median"] *= 9
            row["truth"]["flip"] *= 1.2


def machine_path(data, report):
    valid(data, report)
    (report / "knobs.svg").write_text("<svg><text>--truth /home/me/truth</text></svg>")


def large_image(data, report):
    valid(data, report)
    (report / "knobs.svg").write_text("<svg>" + 160_000 * " " + "</svg>")


def check(condition, message):
    if not condition:
        sys.exit(f"tradeoff_page.py: {message}")


before = (script.parent / "tradeoff.md").read_text()
code, page, images, error = run_script(valid, "--write")
check(code == 0 and images == 6, f"a valid report gives exit code {code} and {images} images: {error}")
check(f"({scene})" in page and "| `cells` | 1 |" in page and page != before, "the page lacks the measured values")
check(run_script(beaten_preset)[0] == 1, "a beaten preset does not give exit code 1")
for change in (machine_path, large_image):
    code, page, images, error = run_script(change, "--write")
    refused = code == 2 and page == before and images == 0 and "knobs.svg" in error
    check(refused, f"{change.__name__}: exit code {code}")
