# SPDX-License-Identifier: Apache-2.0
"""tradeoff_schema.py SCHEMA tradeoff.json: what `ibr tradeoff` writes obeys the schema, and the schema refuses what is
wrong. Exit code 77 where Python's jsonschema (Debian: python3-jsonschema) or the report is not there.
"""
import copy
import json
import os
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)
if not os.path.exists(sys.argv[2]):
    print("skipped: no report, as there is no device")
    sys.exit(77)

BREAKS = [
    lambda r: r.update(version=2),
    lambda r: r.pop("dataset"),
    lambda r: r.update(dataset="abc"),
    lambda r: r.update(views=[]),
    lambda r: r["views"][0].update(size=[1]),
    lambda r: r.update(repeat=0),
    lambda r: r["limits"].pop("subTexelPrecisionBits"),
    lambda r: r["implementation"].append({"name": "x"}),
    lambda r: r["gates"][0].update(holds="yes"),
    lambda r: r["settings"].clear(),
    lambda r: r["settings"][0].pop("setting"),
    lambda r: r["settings"][0].update(labels=[]),
    lambda r: r["settings"][0]["knobs"].pop("filter"),
    lambda r: r["settings"][0].pop("ms"),
    lambda r: r["settings"][0]["ms"].update(device=[1.5]),
    lambda r: r["settings"][0]["ms"].update(median=-1),
    lambda r: r["settings"][0]["truth"].pop("msSsim"),
    lambda r: r["settings"][0]["truth"].update(flip=1.5),
    lambda r: r["settings"][0].update(holes=2),
    lambda r: r["settings"][0]["views"][0].update(prediction=""),
    lambda r: r["settings"][0]["views"][0].update(draws=1.5),
    lambda r: r["settings"][0]["bytes"]["measured"].pop("textures"),
]
with open(sys.argv[1], encoding="utf-8") as file:
    schema = json.load(file)
with open(sys.argv[2], encoding="utf-8") as file:
    report = json.load(file)
Draft202012Validator.check_schema(schema)
validator = Draft202012Validator(schema)
faults = [f"/{'/'.join(map(str, e.absolute_path))}: {e.message[:200]}" for e in validator.iter_errors(report)]
for fault in faults:
    print("refused:", fault)
for number, change in enumerate(BREAKS):
    wrong = copy.deepcopy(report)
    change(wrong)
    if validator.is_valid(wrong):
        faults.append(number)
        print("let pass: wrong document", number)
print(f"{len(faults)} faults; {len(BREAKS)} wrong documents tried")
sys.exit(1 if faults else 0)
