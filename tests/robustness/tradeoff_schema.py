# SPDX-License-Identifier: Apache-2.0
"""tradeoff_schema.py SCHEMA tradeoff.json: the output of `ibr tradeoff` obeys the schema, and the schema refuses wrong
documents. Exit code 77 without Python's jsonschema (Debian: python3-jsonschema) or without a report.
"""
import os
import sys

import schema_check

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
    lambda r: r.pop("sampledDetail"),
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
    lambda r: next(s for s in r["settings"] if "eyes" in s)["eyes"].pop("difference"),
    lambda r: next(s for s in r["settings"] if "eyes" in s)["views"][0]["eyes"].update(seenByBoth=2),
    lambda r: r["settings"][0]["bytes"]["measured"].pop("textures"),
]
schema_check.run(lambda report: report, BREAKS)
