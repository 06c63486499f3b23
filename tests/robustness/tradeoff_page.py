# SPDX-License-Identifier: Apache-2.0
"""tradeoff_page.py tradeoff.py OUT PLACE: libibr/docs/tradeoff.py, on a copy of the report in OUT/PLACE/report, writes
what was measured, says by its exit code where a preset is beaten, and writes no path of a machine and no large picture.
Exit code 77 where there is no report, as there is no device.
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
    """Exit code and page after `damage` was done to the report."""
    with tempfile.TemporaryDirectory() as scratch:
        docs, report = pathlib.Path(scratch, "docs"), pathlib.Path(scratch, "out", place, "report")
        docs.mkdir()
        (docs / "pictures").mkdir()
        for name in ("tradeoff.py", "tradeoff.md"):
            shutil.copy(script.parent / name, docs / name)
        shutil.copytree(out / place / "report", report)
        read = json.loads((report / "tradeoff.json").read_text())
        # Times are of this machine, now: here as they would be if all took a time that grows with what is drawn.
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
    for file in report.glob("*.svg"):  # the command of the test has folders of this machine
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
check(code == 0 and pictures == 6, f"a good report: exit code {code}, {pictures} pictures: {error}")
check(f"({place})" in page and "| `cells` | 1 |" in page and page != before, "the page has not what was measured")
check(tried(beaten)[0] == 1, "a preset is beaten, and nothing says so")
for damage in (path, large):
    code, page, pictures, error = tried(damage, "--write")
    refused = code == 2 and page == before and pictures == 0 and "knobs.svg" in error
    check(refused, f"{damage.__name__}: exit code {code}")
