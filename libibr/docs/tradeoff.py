# SPDX-License-Identifier: Apache-2.0
"""tradeoff.py OUT [--write]: prints the settings that libibr/docs/tradeoff.sh measured on all scenes, as Markdown. Time
and FLIP are geometric means over the scenes, relative to the default; * marks the Pareto front of the two. --write puts
tables and numbers between the markers of libibr/docs/tradeoff.md, and the figures of one scene into the folder pictures.
Exit code 1: a setting beats a preset by more than 3 % in both time and error; 2: reports are missing, or the page
cannot be written."""
import argparse
import json
import math
import pathlib
import re
import sys

DEFAULT = "preset balanced"
PRESETS = ("fast", "balanced", "accurate", "reference")
FIGURE_SCENES = ("street", "hall")  # the page shows the figures of the first measured scene of this list
FIGURES = ("pareto", "knobs", "memory", "passes", "histogram")
MAX_IMAGE_BYTES = 150_000
PAGE = pathlib.Path(__file__).resolve().parent / "tradeoff.md"
# Matches an absolute path, but no part of a URL, a closing tag or a ratio.
MACHINE_PATH = re.compile(r"(?<![\w.:/<~)}-])(?:/[A-Za-z][\w.-]*){2,}|[A-Z]:\\\w|file://")


def fail(message):
    print(f"tradeoff.py: {message}", file=sys.stderr)
    sys.exit(2)


def read(folder):
    files = sorted(folder.glob("*/report/tradeoff.json"))
    reports = {file.parent.parent.name: json.loads(file.read_text()) for file in files}
    if not reports:
        fail(f"{folder}: contains no SCENE/report/tradeoff.json; run tradeoff.sh first")
    return reports


def rows_of(report):
    """Returns the measured settings with one view, by name."""
    return {r["setting"]: r for r in report["settings"] if "failure" not in r and r["knobs"]["views"] == 1}


def table(head, lines):
    all_lines = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in all_lines)


class Scenes:
    def __init__(self, reports):
        self.reports = reports
        self.rows = {scene: rows_of(report) for scene, report in reports.items()}
        first = next(iter(self.rows.values()))
        self.means = {name: self.mean(name) for name in first if all(name in rows for rows in self.rows.values())}

    def mean(self, name):
        """Returns time and FLIP relative to the default, and the difference of PSNR, dB."""
        pairs = [(rows[name], rows[DEFAULT]) for rows in self.rows.values()]

        def ratio(figure):
            return math.exp(sum(math.log(figure(row) / figure(default)) for row, default in pairs) / len(pairs))

        return (ratio(lambda r: r["ms"]["median"]), ratio(lambda r: r["truth"]["flip"]),
                sum(row["truth"]["psnr"] - default["truth"]["psnr"] for row, default in pairs) / len(pairs))

    def beaten(self):
        """Returns, by preset, the settings that are more than 3 % better in both time and error."""
        found = {}
        for preset in PRESETS:
            time, flip, _ = self.means["preset " + preset]
            found[preset] = [n for n, (t, f, _) in self.means.items() if t < 0.97 * time and f < 0.97 * flip]
        return found

    def all_settings(self):
        lines, min_flip = [], math.inf
        for name, (time, flip, psnr) in sorted(self.means.items(), key=lambda item: item[1]):
            lines.append(("*" if flip < min_flip else "", name, f"{time:.2f}", f"{flip:.4f}", f"{psnr:+.2f}"))
            min_flip = min(min_flip, flip)
        return table(("", "setting", "time", "FLIP", "PSNR, dB"), lines)

    def about(self):
        report = next(iter(self.reports.values()))
        sizes = sorted({view["size"][0] for each in self.reports.values() for view in each["views"]})
        wide = " to ".join(str(size) for size in sorted({sizes[0], sizes[-1]}))
        return (f"Device: {report['device']}" + (", a software device" if report["software"] else "") +
                f"; {report['cores']} CPU cores. {report['repeat']} rounds of {len(self.means)} settings on "
                f"{len(self.rows)} scene{'s' * (len(self.rows) > 1)} ({', '.join(self.rows)}); images are {wide} px wide." +
                (" **With fewer than 3 rounds, times have the right order of magnitude only.**"
                 if report["repeat"] < 3 else ""))

    def knobs(self):
        lines = []
        for knob in next(iter(self.reports.values()))["knobs"]:
            knob_name = knob["name"]
            for name, row in next(iter(self.rows.values())).items():
                value = next((label["value"] for label in row["labels"] if label["knob"] == knob_name), None)
                if value is None or name not in self.means or name == DEFAULT:
                    continue
                time, flip, psnr = self.means[name]
                lines.append((f"`{knob_name}`", value, f"{time:.2f}", f"{flip:.3f}", f"{psnr:+.2f}"))
        seen, short = set(), []
        for line in lines:
            short.append(("" if line[0] in seen else line[0],) + line[1:])
            seen.add(line[0])
        return table(("knob", "value", "time", "FLIP", "PSNR, dB"), short)

    def presets(self):
        def cell(row):
            return f"{row['ms']['median']:.1f}, {row['truth']['flip']:.4f}"

        lines = [(scene, *(cell(rows["preset " + p]) for p in PRESETS)) for scene, rows in self.rows.items()]
        means = [self.means["preset " + p] for p in PRESETS]
        lines.append(("all, relative to balanced", *(f"{time:.2f}, {flip:.3f}" for time, flip, _ in means)))
        text = table(("ms, FLIP", *(f"`{p}`" for p in PRESETS)), lines)
        beaten = [f"`{p}` is beaten by {', '.join(by)}" for p, by in self.beaten().items() if by]
        return text + "\n\nOver all scenes, " + ("; ".join(beaten) if beaten else "no preset is beaten in both") + "."

    def gates(self):
        lines = [(scene, gate["gate"], gate["found"]) for scene, report in self.reports.items()
                 for gate in report["gates"] if not gate["holds"]]
        return table(("scene", "unmet guarantee", "measured"), lines) if lines else "All guarantees are met."

    def eyes(self):
        def cells(eyes):
            figures = (100 * eyes["seenByBoth"], 100 * (eyes["sameCell"] or 0), eyes["difference"], eyes["difference95"])
            return ["–" if figure is None else f"{figure:.2f}" for figure in figures]

        lines = [(scene, row["setting"], *cells(row["eyes"])) for scene, report in self.reports.items()
                 for row in report["settings"] if "eyes" in row]
        return table(("scene", "setting", "seen by both, %", "by the same cell, %", "mean difference, 8-bit levels",
                      "95 % quantile"), lines) if lines else "Two eyes were not measured."

    def reference(self):
        lines = [(scene, view["name"], f"{100 * view['compared']:.1f}", f"{view['meanLevels']:.3f}",
                  f"{view['largestLevels']:.1f}", f"{100 * view['beyondBound']:.4f}")
                 for scene, report in self.reports.items() for view in report["implementation"]]
        return table(("scene", "view", "compared pixels, %", "mean difference, 8-bit levels", "maximum",
                      "beyond the bound, %"), lines)


def worst_views(html, size, presets):
    """Returns an SVG drawing of each preset's worst view: rendered image, truth, FLIP. The report has these JPEG images
    in this order."""
    parts, top = [], 0
    height = round(240 * size[1] / size[0])
    for preset in presets:
        found = re.search(rf"<h3>({preset}: [^<]*)</h3>\s*<p>(.*?)</p>", html, re.S)
        if not found:
            fail(f"report.html: contains no worst view of {preset}")
        parts.append(f'<text x="4" y="{top + 14}">{found[1]}</text>')
        images = re.findall(r'alt="([^"]*)"[^>]*src="(data:image/jpeg;base64,[^"]*)"', found[2])
        for column, (name, source) in enumerate(images):
            parts.append(f'<image x="{4 + 246 * column}" y="{top + 20}" width="240" height="{height}" '
                         f'href="{source}"><title>{name}</title></image>')
        top += height + 28
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 740 {top}" width="740" height="{top}" '
            'font-family="sans-serif" font-size="12" fill="#202830">\n'
            '<rect width="100%" height="100%" fill="#ffffff"/>\n' + "\n".join(parts) + "\n</svg>\n")


def machine_paths(text):
    return MACHINE_PATH.findall(re.sub(r'href="data:[^"]*"|</?[a-z]\w*|/>|xmlns="[^"]*"', "", text))


def with_section(page, name, text):
    """Returns the page with `text` between the markers of section `name`."""
    begin, end = f"<!-- measured: {name} -->", "<!-- end -->"
    at = page.find(begin)
    if at < 0 or page.find(end, at) < 0:
        fail(f"{PAGE.name}: the markers {begin} … {end} are missing")
    return page[:at + len(begin)] + "\n" + text + "\n" + page[page.find(end, at):]


def write(folder, scenes):
    shown = next((s for s in FIGURE_SCENES if s in scenes.reports), next(iter(scenes.reports)))
    report = folder / shown / "report"
    page = PAGE.read_text()
    for name in ("about", "knobs", "presets", "gates", "eyes", "reference"):
        page = with_section(page, name, getattr(scenes, name)())
    page = with_section(page, "shown", f"The figures show the scene {shown}.")
    files = {PAGE: page}
    for name in (*FIGURES, *(["optimiser"] if (report / "optimiser.svg").exists() else [])):
        files[PAGE.parent / "pictures" / f"tradeoff-{name}.svg"] = (report / f"{name}.svg").read_text()
    html, size = (report / "report.html").read_text(), scenes.reports[shown]["views"][0]["size"]
    drawings = [worst_views(html, size, presets) for presets in (("fast", "reference"), ("fast",))]
    files[PAGE.parent / "pictures" / "tradeoff-worst.svg"] = next(
        (drawing for drawing in drawings if len(drawing.encode()) <= MAX_IMAGE_BYTES), drawings[-1])
    for file, text in files.items():
        if paths := machine_paths(text):
            fail(f"{file.name}: contains a path of this machine: {paths[0]}")
        if file.suffix == ".svg" and len(text.encode()) > MAX_IMAGE_BYTES:
            fail(f"{file.name}: {len(text.encode())} bytes exceed the limit of {MAX_IMAGE_BYTES}")
    for file, text in files.items():
        file.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="OUT", type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="write the page and its figures")
    options = parser.parse_args()
    scenes = Scenes(read(options.folder))
    print(f"{scenes.about()}\n\n{scenes.all_settings()}\n")
    beaten = scenes.beaten()
    for preset, by in beaten.items():
        print(f"{preset}: {'beaten by ' + ', '.join(by) if by else 'not beaten'}")
    if options.write:
        write(options.folder, scenes)
    sys.exit(any(beaten.values()))


if __name__ == "__main__":
    main()
