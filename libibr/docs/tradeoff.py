# SPDX-License-Identifier: Apache-2.0
"""tradeoff.py OUT [--write]: settings over all places that libibr/docs/tradeoff.sh measured, as Markdown. Time and FLIP
are geometric means over the places of their ratio to the default's; * marks the front of the two. --write puts tables
and numbers between the markers of libibr/docs/tradeoff.md, and the figures of one place beside it. Exit code 1 where a
preset is beaten by more than 3 % in both time and error, 2 where nothing can be said or written."""
import argparse
import json
import math
import pathlib
import re
import sys

DEFAULT = "preset balanced"
PRESETS = ("fast", "balanced", "accurate", "reference")
SHOWN = ("street", "hall")  # whose figures the page has: the first that was measured
FIGURES = ("pareto", "knobs", "memory", "passes", "histogram")
LARGEST_PICTURE = 150_000  # bytes
PAGE = pathlib.Path(__file__).resolve().parent / "tradeoff.md"
# A path from the root of a machine, and not a part of an address, a closing tag or a ratio.
MACHINE_PATH = re.compile(r"(?<![\w.:/<~)}-])(?:/[A-Za-z][\w.-]*){2,}|[A-Z]:\\\w|file://")


def fail(why):
    print(f"tradeoff.py: {why}", file=sys.stderr)
    sys.exit(2)


def read(folder):
    files = sorted(folder.glob("*/report/tradeoff.json"))
    reports = {file.parent.parent.name: json.loads(file.read_text()) for file in files}
    if not reports:
        fail(f"{folder}: has no PLACE/report/tradeoff.json")
    return reports


def rows_of(report):
    """Settings that were drawn, for one view, by name."""
    return {r["setting"]: r for r in report["settings"] if "failure" not in r and r["knobs"]["views"] == 1}


def table(head, lines):
    every = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in every)


class Places:
    def __init__(self, reports):
        self.reports = reports
        self.rows = {place: rows_of(report) for place, report in reports.items()}
        first = next(iter(self.rows.values()))
        self.means = {name: self.mean(name) for name in first if all(name in of for of in self.rows.values())}

    def mean(self, name):
        """Time and FLIP as ratios to the default's, PSNR as a difference, dB."""
        pairs = [(of[name], of[DEFAULT]) for of in self.rows.values()]

        def ratio(figure):
            return math.exp(sum(math.log(figure(row) / figure(usual)) for row, usual in pairs) / len(pairs))

        return (ratio(lambda r: r["ms"]["median"]), ratio(lambda r: r["truth"]["flip"]),
                sum(row["truth"]["psnr"] - usual["truth"]["psnr"] for row, usual in pairs) / len(pairs))

    def beaten(self):
        """By preset: the settings that are more than 3 % better in both."""
        found = {}
        for preset in PRESETS:
            time, flip, _ = self.means["preset " + preset]
            found[preset] = [n for n, (t, f, _) in self.means.items() if t < 0.97 * time and f < 0.97 * flip]
        return found

    def all_settings(self):
        lines, least = [], math.inf
        for name, (time, flip, psnr) in sorted(self.means.items(), key=lambda item: item[1]):
            lines.append(("*" if flip < least else "", name, f"{time:.2f}", f"{flip:.4f}", f"{psnr:+.2f}"))
            least = min(least, flip)
        return table(("", "setting", "time", "FLIP", "PSNR, dB"), lines)

    def about(self):
        report = next(iter(self.reports.values()))
        sizes = sorted({view["size"][0] for each in self.reports.values() for view in each["views"]})
        wide = " to ".join(str(size) for size in sorted({sizes[0], sizes[-1]}))
        return (f"Device: {report['device']}" + (", which is software" if report["software"] else "") +
                f"; {report['cores']} processor cores. Rounds: {report['repeat']}, of {len(self.means)} settings in "
                f"{len(self.rows)} places ({', '.join(self.rows)}); pictures are {wide} px wide." +
                (" **So few rounds tell times to an order of magnitude, no more.**" if report["repeat"] < 3 else ""))

    def knobs(self):
        lines = []
        for knob in next(iter(self.reports.values()))["knobs"]:
            named = knob["name"]
            for name, row in next(iter(self.rows.values())).items():
                value = next((label["value"] for label in row["labels"] if label["knob"] == named), None)
                if value is None or name not in self.means or name == DEFAULT:
                    continue
                time, flip, psnr = self.means[name]
                lines.append((f"`{named}`", value, f"{time:.2f}", f"{flip:.3f}", f"{psnr:+.2f}"))
        seen, short = set(), []
        for line in lines:
            short.append(("" if line[0] in seen else line[0],) + line[1:])
            seen.add(line[0])
        return table(("knob", "value", "time", "FLIP", "PSNR, dB"), short)

    def presets(self):
        def cell(row):
            return f"{row['ms']['median']:.1f}, {row['truth']['flip']:.4f}"

        lines = [(place, *(cell(of["preset " + p]) for p in PRESETS)) for place, of in self.rows.items()]
        means = [self.means["preset " + p] for p in PRESETS]
        lines.append(("all, of balanced's", *(f"{time:.2f}, {flip:.3f}" for time, flip, _ in means)))
        text = table(("ms, FLIP", *(f"`{p}`" for p in PRESETS)), lines)
        beaten = [f"`{p}` is beaten by {', '.join(by)}" for p, by in self.beaten().items() if by]
        return text + "\n\nOver all places " + ("; ".join(beaten) if beaten else "no preset is beaten in both") + "."

    def gates(self):
        lines = [(place, gate["gate"], gate["found"]) for place, report in self.reports.items()
                 for gate in report["gates"] if not gate["holds"]]
        return table(("place", "promise that does not hold", "found"), lines) if lines else "All promises hold."

    def eyes(self):
        def cells(eyes):
            figures = (100 * eyes["seenByBoth"], 100 * (eyes["sameCell"] or 0), eyes["difference"], eyes["difference95"])
            return ["–" if figure is None else f"{figure:.2f}" for figure in figures]

        lines = [(place, row["setting"], *cells(row["eyes"])) for place, report in self.reports.items()
                 for row in report["settings"] if "eyes" in row]
        return table(("place", "setting", "seen by both, %", "by the same cell, %", "difference, levels",
                      "95 % less than"), lines) if lines else "Two eyes were not measured."

    def twin(self):
        lines = [(place, view["name"], f"{100 * view['compared']:.1f}", f"{view['meanLevels']:.3f}",
                  f"{view['largestLevels']:.1f}", f"{100 * view['beyondBound']:.4f}")
                 for place, report in self.reports.items() for view in report["implementation"]]
        return table(("place", "view", "compared, %", "mean, levels", "largest", "beyond the bound, %"), lines)


def worst_views(html, size, presets):
    """A drawing of the views that presets show worst: what is shown, the truth, FLIP. From the report, which has them
    as JPEG in the same order."""
    parts, top = [], 0
    height = round(240 * size[1] / size[0])
    for preset in presets:
        found = re.search(rf"<h3>({preset}: [^<]*)</h3>\s*<p>(.*?)</p>", html, re.S)
        if not found:
            fail(f"report.html: has no worst view of {preset}")
        parts.append(f'<text x="4" y="{top + 14}">{found[1]}</text>')
        pictures = re.findall(r'alt="([^"]*)"[^>]*src="(data:image/jpeg;base64,[^"]*)"', found[2])
        for column, (name, source) in enumerate(pictures):
            parts.append(f'<image x="{4 + 246 * column}" y="{top + 20}" width="240" height="{height}" '
                         f'href="{source}"><title>{name}</title></image>')
        top += height + 28
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 740 {top}" width="740" height="{top}" '
            'font-family="sans-serif" font-size="12" fill="#202830">\n'
            '<rect width="100%" height="100%" fill="#ffffff"/>\n' + "\n".join(parts) + "\n</svg>\n")


def machine_paths(text):
    return MACHINE_PATH.findall(re.sub(r'href="data:[^"]*"|</?[a-z]\w*|/>|xmlns="[^"]*"', "", text))


def between(page, name, text):
    """The page with `text` between the markers of that name."""
    begin, end = f"<!-- measured: {name} -->", "<!-- end -->"
    at = page.find(begin)
    if at < 0 or page.find(end, at) < 0:
        fail(f"{PAGE.name}: has no {begin} … {end}")
    return page[:at + len(begin)] + "\n" + text + "\n" + page[page.find(end, at):]


def write(folder, places):
    place = next((p for p in SHOWN if p in places.reports), next(iter(places.reports)))
    report = folder / place / "report"
    page = PAGE.read_text()
    for name in ("about", "knobs", "presets", "gates", "eyes", "twin"):
        page = between(page, name, getattr(places, name)())
    page = between(page, "shown", f"The figures are of the {place}.")
    files = {PAGE: page}
    for name in (*FIGURES, *(["optimiser"] if (report / "optimiser.svg").exists() else [])):
        files[PAGE.parent / "pictures" / f"tradeoff-{name}.svg"] = (report / f"{name}.svg").read_text()
    html, size = (report / "report.html").read_text(), places.reports[place]["views"][0]["size"]
    drawings = [worst_views(html, size, presets) for presets in (("fast", "reference"), ("fast",))]
    files[PAGE.parent / "pictures" / "tradeoff-worst.svg"] = next(
        (drawing for drawing in drawings if len(drawing.encode()) <= LARGEST_PICTURE), drawings[-1])
    for file, text in files.items():
        if paths := machine_paths(text):
            fail(f"{file.name}: has a path of this machine: {paths[0]}")
        if file.suffix == ".svg" and len(text.encode()) > LARGEST_PICTURE:
            fail(f"{file.name}: {len(text.encode())} bytes are more than {LARGEST_PICTURE}")
    for file, text in files.items():
        file.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="OUT", type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="write the page and its figures")
    wish = parser.parse_args()
    places = Places(read(wish.folder))
    print(f"{places.about()}\n\n{places.all_settings()}\n")
    beaten = places.beaten()
    for preset, by in beaten.items():
        print(f"{preset}: {'beaten by ' + ', '.join(by) if by else 'not beaten'}")
    if wish.write:
        write(wish.folder, places)
    sys.exit(any(beaten.values()))


if __name__ == "__main__":
    main()
