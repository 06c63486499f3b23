# SPDX-License-Identifier: Apache-2.0
"""tradeoff_page.py tradeoff.py OUT PLACE: runs libibr/docs/tradeoff.py on a copy of the report in OUT/PLACE/report and
checks that the page has the measured values, that the exit code reports a beaten preset, and that local paths and large
images are refused. Exit code 77 without a report, that is, without a Vulkan device.
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

script, out, place = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
if not (out / place / "report" / "tradeoff.json").exists():
    print("skipped: no report, as there is no device")
    sys.exit(77)


def tried(damage, *options):
    """Returns exit code, page, number of images and stderr after `damage` has changed the report."""
    with tempfile.TemporaryDirectory() as scratch:
        docs, report = pathlib.Path(scratch, "docs"), pathlib.Path(scratch, "out", place, "report")
        docs.mkdir()
        (docs / "pictures").mkdir()
        for name in ("tradeoff.py", "tradeoff.md"):
            shutil.copy(script.parent / name, docs / name)
        shutil.copytree(out / place / "report", report)
        read = json.loads((report / "tradeoff.json").read_text())
        # Replaces measured times by times proportional to the drawn triangles, so that the test is deterministic.
        for row in read["settings"]:
            if "failure" not in row:
                row["ms"]["median"] = 1 + sum(view["triangles"] for view in row["views"])
        read["command"] = "ibr tradeoff"
        damage(read, report)
        (report / "tradeoff.json").write_text(json.dumps(read))
        line = [sys.executable, docs / "tradeoff.py", report.parents[1], *options]
        ran = subprocess.run(line, capture_output=True, text=True)
        return ran.returncode, (docs / "tradeoff.md").read_text(), len(list((docs / "pictures").iterdir())), ran.stderr


def plain(read, report):
    for file in report.glob("*.svg"):  # the test's command contains folders of this machine
        file.write_text("<svg></svg>")


def beaten(read, report):
    plain(read, report)
    for row in read["settings"]:
        if row["setting"] == "preset accurate":
            row["ms"]["median"] *= 9
            row["truth"]["flip"] *= 1.2


def path(read, report):
    plain(read, report)
    (report / "knobs.svg").write_text("<svg><text>--truth /home/me/truth</text></svg>")


def large(read, report):
    plain(read, report)
    (report / "knobs.svg").write_text("<svg>" + 160_000 * " " + "</svg>")


def check(holds, what):
    if not holds:
        sys.exit(f"tradeoff_page.py: {what}")


before = (script.parent / "tradeoff.md").read_text()
code, page, pictures, error = tried(plain, "--write")
check(code == 0 and pictures == 6, f"a valid report gives exit code {code} and {pictures} pictures: {error}")
check(f"({place})" in page and "| `cells` | 1 |" in page and page != before, "the page lacks the measured values")
check(tried(beaten)[0] == 1, "a beaten preset does not give exit code 1")
for damage in (path, large):
    code, page, pictures, error = tried(damage, "--write")
    refused = code == 2 and page == before and pictures == 0 and "knobs.svg" in error
    check(refused, f"{damage.__name__}: exit code {code}")
