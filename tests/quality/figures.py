# SPDX-License-Identifier: Apache-2.0
"""Figures from reports of `ibr eval`: scores of views, mean scores, the worst view, and the view with the largest
loss."""
import math


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def sum_or_none(a, b):
    return None if a is None or b is None else a + b


def quotient(a, b):
    return a / b if is_number(a) and is_number(b) and b > 0 else None


def rounded(scores):
    return {key: round(value, 4) if is_number(value) else None for key, value in scores.items()}


def views_of(result, column):
    """Returns scores by view name. `column` is now or the name of a baseline."""
    found = {}
    for view in result["views"]:
        scores = view if column == "now" else (view.get("baselines") or {}).get(column)
        if scores and is_number(scores.get("psnr")):
            found[view["name"]] = {k: v for k, v in scores.items() if k not in ("name", "baselines")}
    return found


def mean_of(views):
    """Returns the mean of each figure, over the views that have this figure."""
    keys = dict.fromkeys(key for scores in views.values() for key in scores)
    means = {}
    for key in keys:
        values = [scores[key] for scores in views.values() if is_number(scores.get(key))]
        if values:
            means[key] = sum(values) / len(values)
    return means


def summary(result):
    """Returns, by column, mean figures, the worst view and all views. Columns that were not measured are missing."""
    columns = {}
    for column in ("now", "lumigraph", "gathered"):
        views = views_of(result, column)
        if views:
            worst = min(views, key=lambda name: views[name]["psnr"])
            columns[column] = {"mean": mean_of(views), "worst": worst, "views": views}
    return columns


def largest_loss(previous, views):
    """Returns (name, dB) of the view with the largest PSNR loss against frozen views, or None."""
    changes = [(views[name]["psnr"] - scores["psnr"], name) for name, scores in previous.items()
               if name in views and is_number(scores.get("psnr"))]
    return min(changes)[::-1] if changes else None
