# SPDX-License-Identifier: Apache-2.0
"""Markdown page quality.md: one table for each kind of metric, with one row per set. Columns without values are left
out."""
from figures import is_number, largest_loss, sum_or_none, summary


def text_of(value, decimals, factor=1):
    return f"{factor * value:.{decimals}f}" if is_number(value) else "–"


def signed(change):
    """Returns a change with its sign, but never "-0.00"."""
    return f"{round(change, 2) + 0.0:+.2f}" if is_number(change) else ""


def pair(scores, decimals=(2, 3)):
    """Returns "PSNR / SSIM", or an empty text without a PSNR."""
    if not scores or not is_number(scores.get("psnr")):
        return ""
    return f"{text_of(scores['psnr'], decimals[0])} / {text_of(scores.get('ssim'), decimals[1])}"


def table(head, rows):
    """Returns a Markdown table without empty columns."""
    columns = [i for i in range(len(head)) if i == 0 or any(row[i] != "" for row in rows)]
    lines = [[line[i] for i in columns] for line in (head, ["---"] * len(head), *rows)]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def both(columns, key, decimals, factor=1):
    """Returns a metric as "now · gathered" (program · reference implementation of the gather), or an empty text if
    neither has a value."""
    values = [columns.get(column, {}).get("mean", {}).get(key) for column in ("now", "gathered")]
    if not any(is_number(value) for value in values):
        return ""
    return " · ".join(text_of(value, decimals, factor) for value in values)


def views_table(summaries, previous, previous_name):
    rows = []
    for name, columns in summaries.items():
        old = previous.get(name, {})
        means = {column: figures["mean"] for column, figures in columns.items()}
        change = sum_or_none(means.get("now", {}).get("psnr"), -value) \
            if is_number(value := old.get("now", {}).get("mean", {}).get("psnr")) else None
        rows.append([name, len(columns.get("now", {}).get("views", {})), pair(old.get("now", {}).get("mean")),
                     pair(old.get("lumigraph", {}).get("mean")), pair(means.get("now")), pair(means.get("gathered")),
                     pair(means.get("lumigraph")), signed(change)])
    return table(["PSNR dB / SSIM", "views", previous_name, f"lumigraph of {previous_name}", "now", "gathered",
                  "lumigraph now", f"now − {previous_name}, dB"], rows)


def detail_table(summaries):
    rows = [[name, both(columns, "psnrGain", 2), both(columns, "flip", 3), both(columns, "detailEnergy", 2),
             both(columns, "detailCorrelation", 3), both(columns, "tornTiles", 1, 100),
             both(columns, "guessed", 1, 100)]
            for name, columns in summaries.items()]
    return table(["now · gathered", "PSNR after gain, dB", "FLIP", "detail energy", "detail correlation",
                  "torn tiles, %", "depth guessed, %"], rows)


def worst_text(columns, column):
    if column not in columns:
        return ""
    worst = columns[column]["worst"]
    return f"{worst} {pair(columns[column]['views'][worst], (1, 2))}"


def cost_table(summaries, results, previous, previous_name):
    rows = []
    for name, result in results.items():
        columns, build = summaries.get(name, {}), result["build"]
        loss = largest_loss(previous.get(name, {}).get("now", {}).get("views", {}),
                            columns.get("now", {}).get("views", {}))
        rows.append([name, worst_text(columns, "now"), worst_text(columns, "gathered"),
                     f"{loss[0]} {signed(loss[1])}" if loss else "", text_of(build["cpuSecondsPerMegapixel"], 1),
                     both(columns, "milliseconds", 0)])
    return table(["worst views, PSNR dB / SSIM", "now", "gathered", f"smallest gain over {previous_name}, dB",
                  "build, CPU s/MP", "ms per frame, now · gathered"], rows)


def depth_table(summaries):
    keys = ("rightDepth", "tooFar", "tooNear")
    rows = [[name, *(both(columns, key, 3) for key in keys)] for name, columns in summaries.items()
            if any(both(columns, key, 3) for key in keys)]
    return table(["depth, now · gathered", "right to 1 px at 0.3 m", "too far", "too near"], rows) if rows else ""


def markdown(results, previous, about):
    """Returns the page. `previous` is the result of freeze(); its values are in the first columns."""
    previous_sets, previous_name = previous.get("sets", {}), previous.get("program", "previous")
    summaries = {name: columns for name, result in results.items() if (columns := summary(result))}
    devices = sorted({result["device"] for result in results.values() if result.get("device")})
    parts = ["# Quality of held-out views", "",
             f"Program {about['program']['hash']} ({about['program']['describe']}), configuration "
             f"{about['configuration']}, on {', '.join(devices) or 'no device'}. “gathered” is the reference "
             "implementation of the gather. Empty cells were not measured.", "",
             views_table(summaries, previous_sets, previous_name), "", detail_table(summaries), "",
             cost_table(summaries, results, previous_sets, previous_name)]
    if depth := depth_table(summaries):
        parts += ["", depth]
    images_only = [name for name, result in results.items() if not result["views"]]
    if images_only:
        parts += ["", f"Images only: {', '.join(images_only)}."]
    if previous_sets and previous["configuration"] != about["configuration"]:
        parts += ["", f"{previous_name} was measured with another configuration, {previous['configuration']}."]
    for name, message in about["failed"].items():
        parts += ["", f"{name} failed: {message}"]
    return "\n".join(parts) + "\n"
