# SPDX-License-Identifier: Apache-2.0
"""build_steps_schema.py SCHEMA steps.json: the output of `ibr build --steps` obeys the schema, and the schema refuses
wrong documents. Exit code 77 without Python's jsonschema (Debian: python3-jsonschema).
"""
import schema_check

BREAKS = [
    lambda r: r.update(version=2),
    lambda r: r.pop("scene"),
    lambda r: r.pop("steps"),
    lambda r: r.update(steps=[]),
    lambda r: r["steps"][0].pop("name"),
    lambda r: r["steps"][0].update(name="deep-0001"),
    lambda r: r["steps"][0].update(arguments=["render"]),
    lambda r: r["steps"][0].pop("inputs"),
    lambda r: r["steps"][0].update(output=""),
    lambda r: r["steps"][0].update(seconds=-1),
    lambda r: r["steps"][0].update(memory=None),
    lambda r: r["steps"][0].update(more=1),
]
schema_check.run(lambda report: report, BREAKS)
