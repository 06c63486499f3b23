# SPDX-License-Identifier: Apache-2.0
"""scene_schema.py SCHEMA SCENE.gltf: a scene that we wrote obeys our schema, and the schema refuses what is wrong.

Exit code 77 where Python's jsonschema (Debian: python3-jsonschema) is not installed.
"""
import copy
import json
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)

with open(sys.argv[1], encoding="utf-8") as file:
    schema = json.load(file)
with open(sys.argv[2], encoding="utf-8") as file:
    extension = json.load(file)["extensions"]["IBR_image_graph"]

Draft202012Validator.check_schema(schema)
validator = Draft202012Validator(schema)
faults = [f"/{'/'.join(map(str, e.absolute_path))}: {e.message}" for e in validator.iter_errors(extension)]
for fault in faults:
    print("refused:", fault)

# Each of these breaks one rule; a schema that lets it pass says too little.
BREAKS = [
    lambda e: e.update(version=2),
    lambda e: e.pop("photographs"),
    lambda e: e.update(acquisition="somehow"),
    lambda e: e["origin"].pop("heightMetres"),
    lambda e: e["photographs"][0].pop("node"),
    lambda e: e["photographs"][0].update(node=-1),
    lambda e: e["photographs"][0].update(image=1.5),
    lambda e: e["photographs"][0]["texture"].update(uri="/etc/passwd"),
    lambda e: e["photographs"][0]["texture"].update(uri="file:x"),
    lambda e: e["photographs"][0]["camera"].update(model="FISHEYE"),
    lambda e: e["photographs"][0]["camera"].update(width=0),
    lambda e: e["photographs"][0]["camera"].update(fx=0),
    lambda e: e["photographs"][0]["camera"].pop("cy"),
    lambda e: e["cells"][0].update(members=[0]),
    lambda e: e["cells"][0].update(members=[0, 0]),
    lambda e: e["cells"][0].update(members=[0, 1, 2, 3, 4]),
    lambda e: e["cells"][0].pop("ecc"),
    lambda e: e["cells"][0].update(tiers=[2]),
    lambda e: e["backdrops"][0].update(members=[0, 1]),
]
# Quality of a cell: each figure just outside its range, and of another kind.
BAD_QUALITY = {"coverage": (-0.01, 1.01), "ecc": (-1.01, 1.01), "residualPx": (-0.01,), "score": (-0.01, 1.01)}
for figure, values in BAD_QUALITY.items():
    for value in (*values, "0.5", None):
        BREAKS.append(lambda e, f=figure, v=value: e["cells"][1]["quality"].update({f: v}))
for number, change in enumerate(BREAKS):
    wrong = copy.deepcopy(extension)
    change(wrong)
    if validator.is_valid(wrong):
        faults.append(number)
        print("let pass: wrong document", number)
print(f"{len(faults)} faults; {len(BREAKS)} wrong documents tried")
sys.exit(1 if faults else 0)
