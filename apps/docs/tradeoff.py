# SPDX-License-Identifier: Apache-2.0
"""tradeoff.py OUT: settings over all places that apps/docs/tradeoff.sh measured, as Markdown. Time and FLIP are geometric
means over the places of their ratio to the default's; * marks the front of the two. Exit code 1 where a preset is beaten
by more than 3 % in both."""
import json
import math
import pathlib
import sys

reports = {p.parent.parent.name: json.loads(p.read_text()) for p in sorted(pathlib.Path(sys.argv[1]).glob("*/report/tradeoff.json"))}
DEFAULT = "preset balanced"
rows = {place: {r["setting"]: r for r in report["settings"] if "failure" not in r and r["knobs"]["views"] == 1}
        for place, report in reports.items()}
names = [n for n in next(iter(rows.values())) if all(n in of for of in rows.values())]


def ratio(name, figure):
    return math.exp(sum(math.log(figure(of[name]) / figure(of[DEFAULT])) for of in rows.values()) / len(rows))


found = {}
for name in names:
    found[name] = (ratio(name, lambda r: r["ms"]["median"]), ratio(name, lambda r: r["truth"]["flip"]),
                   sum(of[name]["truth"]["psnr"] - of[DEFAULT]["truth"]["psnr"] for of in rows.values()) / len(rows))
print(f"{len(rows)} places: {', '.join(rows)}; {next(iter(reports.values()))['device']}\n")
print("| | setting | time | FLIP | PSNR, dB |\n|---|---|---|---|---|")
least = math.inf
for name, (time, flip, psnr) in sorted(found.items(), key=lambda item: item[1]):
    print(f"| {'*' if flip < least else ''} | {name} | {time:.2f} | {flip:.4f} | {psnr:+.2f} |")
    least = min(least, flip)
print()
beaten = False
for preset in ("fast", "balanced", "accurate", "reference"):
    time, flip, _ = found["preset " + preset]
    by = [n for n, (t, f, _) in found.items() if t < 0.97 * time and f < 0.97 * flip]
    beaten |= bool(by)
    print(f"{preset}: {'beaten by ' + ', '.join(by) if by else 'not beaten'}")
sys.exit(beaten)
