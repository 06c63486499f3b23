# SPDX-License-Identifier: Apache-2.0
"""scene_schema.py SCHEMA SCENE.gltf: checks the scene against the schema, and that the schema refuses wrong scenes.
Exit code 77 without Python's jsonschema (Debian: python3-jsonschema).
"""
import schema_check

BREAKS = [
    lambda e: e.update(version=1),
    lambda e: e.update(version=3),
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
    lambda e: e["photographs"][1].update(gain=[1, 1]),
    lambda e: e["photographs"][1].update(gain=[1, 1, 0]),
    lambda e: e["photographs"][1].update(gain=[1, 1, 4097]),
    lambda e: e["photographs"][1]["capture"].update(iso=0),
    lambda e: e["photographs"][1]["capture"].update(model=1),
    lambda e: e["photographs"][0]["depth"].pop("uri"),
    lambda e: e["photographs"][0]["depth"].pop("scale"),
    lambda e: e["photographs"][0]["depth"].update(uri="../depth/view0.ktx2:"),
    lambda e: e["photographs"][0]["depth"].update(scale=0),
    lambda e: e["photographs"][0]["depth"].update(scale="1"),
    lambda e: e["cells"][0].update(members=[0]),
    lambda e: e["cells"][0].update(members=[0, 0]),
    lambda e: e["cells"][0].update(members=[0, 1, 2, 3, 4]),
    lambda e: e["cells"][0].pop("ecc"),
    lambda e: e["cells"][0].update(tiers=[2]),
    lambda e: e["backdrops"][0].update(members=[0, 1]),
]
# Quality of a cell: each figure just outside its range, and with another type.
BAD_QUALITY = {"coverage": (-0.01, 1.01), "ecc": (-1.01, 1.01), "residualPx": (-0.01,), "score": (-0.01, 1.01)}
for figure, values in BAD_QUALITY.items():
    for value in (*values, "0.5", None):
        BREAKS.append(lambda e, f=figure, v=value: e["cells"][1]["quality"].update({f: v}))
schema_check.run(lambda document: document["extensions"]["IBR_image_graph"], BREAKS)
