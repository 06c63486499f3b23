# SPDX-License-Identifier: Apache-2.0
"""Reference figures in tests/data: those of one older program for all sets, and the minimum for --small."""
from figures import is_number, rounded, summary
from files import COMPARISON, OK, ROOT, Failure, read_json, say, write_json
from sets import SETS

DATA = ROOT / "tests/data"
FROZEN_FILE = DATA / "quality_2bdd944.json"
SMALL_FILE = DATA / "quality_small.json"

# Maximum loss of a set in --small: dB, and SSIM.
MAX_LOSS = {"psnr": 0.2, "ssim": 0.005}


def frozen_figures(results, program, configuration):
    """Returns figures for comparison with later programs: means of the program and the lumigraph, and the program's
    views."""
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
    """Writes the figures of the program NAME to `file`, quality_NAME.json. Sets that were not run are not changed."""
    known = read_json(file) or {"sets": {}}
    new = frozen_figures(results, file.stem.rpartition("_")[2], configuration)
    sets = {**known["sets"], **new["sets"]}
    write_json(file, {**new, "sets": {each.name: sets[each.name] for each in SETS if each.name in sets}})
    say(f"written: {file}")


def small_table(results, configuration):
    sets = {name: {column: rounded({key: figures["mean"].get(key) for key in MAX_LOSS})
                   for column, figures in summary(result).items() if column in ("now", "gathered")}
            for name, result in results.items()}
    return {"configuration": configuration, "sets": sets}


def previous_of_small(reference):
    """Returns the reference of --small in the format of freeze()."""
    sets = {name: {column: {"mean": scores} for column, scores in columns.items()}
            for name, columns in reference["sets"].items()}
    return {"program": "committed", "configuration": reference["configuration"], "sets": sets}


def losses(reference, current):
    """Returns a line for each figure of small_table() that is missing or more than MAX_LOSS below the reference."""
    lines = []
    for name, columns in reference["sets"].items():
        for column, scores in columns.items():
            found = current["sets"].get(name, {}).get(column, {})
            for key, previous in scores.items():
                value = found.get(key)
                if not is_number(previous):
                    continue
                if not is_number(value):
                    lines.append(f"{name}, {column}: {key} is missing, was {previous:.4f}")
                elif previous - value > MAX_LOSS[key] + 1e-9:
                    lines.append(f"{name}, {column}: {key} {value:.4f}, was {previous:.4f}; "
                                 f"a loss of {MAX_LOSS[key]} is allowed")
    return lines


def judge_small(options, results, configuration):
    """Returns the exit code of --small."""
    current = small_table(results, configuration)
    if options.write:
        write_json(SMALL_FILE, current)
        say(f"written: {SMALL_FILE}")
        return OK
    reference = read_json(SMALL_FILE)
    if reference is None:
        raise Failure(f"{SMALL_FILE}: is missing; write it with tests/quality.sh --small --write")
    if reference["configuration"] != configuration:
        say(f"{SMALL_FILE.name} was written with another configuration; if the change is intended, run with --write")
    if options.names:
        reference["sets"] = {name: columns for name, columns in reference["sets"].items() if name in options.names}
    lines = losses(reference, current)
    for line in lines:
        say(f"worse: {line}")
    return COMPARISON if lines else OK
