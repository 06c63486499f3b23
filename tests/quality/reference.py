# SPDX-License-Identifier: Apache-2.0
"""Figures that are kept in tests/data to compare later programs with: those of one older program for all sets, and
those that --small must not fall below."""
from figures import is_number, rounded, summary
from files import COMPARISON, OK, ROOT, Failure, read_json, say, write_json
from sets import SETS

DATA = ROOT / "tests/data"
FROZEN_FILE = DATA / "quality_2bdd944.json"
SMALL_FILE = DATA / "quality_small.json"

# What --small allows a set to lose: dB, and SSIM.
LARGEST_LOSS = {"psnr": 0.2, "ssim": 0.005}


def frozen(results, program, configuration):
    """Figures to compare later programs with: means of ours and of the lumigraph, and our views."""
    sets = {}
    for name, result in results.items():
        columns = summary(result)
        if "now" not in columns:
            continue
        sets[name] = {column: {"mean": rounded(columns[column]["mean"])}
                      for column in ("now", "lumigraph") if column in columns}
        sets[name]["now"]["views"] = {view: rounded({k: scores.get(k) for k in ("psnr", "psnrGain", "ssim")})
                                      for view, scores in columns["now"]["views"].items()}
        sets[name]["build"] = rounded({"cpuSecondsPerMegapixel": result["build"]["cpuSecondsPerMegapixel"]})
    return {"program": program, "configuration": configuration, "sets": sets}


def freeze(file, results, configuration):
    """quality_NAME.json is of the program NAME. Sets that were not run stay as they are."""
    known = read_json(file) or {"sets": {}}
    new = frozen(results, file.stem.rpartition("_")[2], configuration)
    sets = {**known["sets"], **new["sets"]}
    write_json(file, {**new, "sets": {each.name: sets[each.name] for each in SETS if each.name in sets}})
    say(f"written: {file}")


def small_table(results, configuration):
    sets = {name: {column: rounded({key: of["mean"].get(key) for key in LARGEST_LOSS})
                   for column, of in summary(result).items() if column in ("now", "gathered")}
            for name, result in results.items()}
    return {"configuration": configuration, "sets": sets}


def former_of_small(reference):
    """The reference of --small in the form of freeze()."""
    sets = {name: {column: {"mean": scores} for column, scores in columns.items()}
            for name, columns in reference["sets"].items()}
    return {"program": "committed", "configuration": reference["configuration"], "sets": sets}


def losses(reference, current):
    """Lines that name figures of small_table() that are missing, or by more than LARGEST_LOSS below the reference."""
    lines = []
    for name, columns in reference["sets"].items():
        for column, scores in columns.items():
            found = current["sets"].get(name, {}).get(column, {})
            for key, former in scores.items():
                value = found.get(key)
                if not is_number(former):
                    continue
                if not is_number(value):
                    lines.append(f"{name}, {column}: {key} is missing, was {former:.4f}")
                elif former - value > LARGEST_LOSS[key] + 1e-9:
                    lines.append(f"{name}, {column}: {key} {value:.4f}, was {former:.4f}; "
                                 f"{LARGEST_LOSS[key]} less is allowed")
    return lines


def judge_small(options, results, configuration):
    """Exit code of --small."""
    current = small_table(results, configuration)
    if options.write:
        write_json(SMALL_FILE, current)
        say(f"written: {SMALL_FILE}")
        return OK
    reference = read_json(SMALL_FILE)
    if reference is None:
        raise Failure(f"{SMALL_FILE}: is missing; tests/quality.sh --small --write makes it")
    if reference["configuration"] != configuration:
        say(f"{SMALL_FILE.name} was written with another configuration; --write where that is meant")
    if options.names:
        reference["sets"] = {name: of for name, of in reference["sets"].items() if name in options.names}
    lines = losses(reference, current)
    for line in lines:
        say(f"worse: {line}")
    return COMPARISON if lines else OK
