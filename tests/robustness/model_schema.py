# SPDX-License-Identifier: Apache-2.0
"""model_schema.py SCHEMA MODEL.gltf: checks the model against the schema, and that the schema refuses wrong models.
Exit code 77 without Python's jsonschema (Debian: python3-jsonschema).
"""
import schema_check

BREAKS = [
    lambda e: e.update(version=2),
    lambda e: e.pop("version"),
    lambda e: e.pop("cameras"),
    lambda e: e.update(cameras=[]),
    lambda e: e.update(cameras=e["cameras"] * 33),
    lambda e: e.pop("surface"),
    lambda e: e["surface"].pop("node"),
    lambda e: e["surface"].update(node=-1),
    lambda e: e["source"].update(node="0"),
    lambda e: e.update(complements=0.5),
    lambda e: e.update(complements=-1),
    lambda e: e["cameras"][0].pop("node"),
    lambda e: e["cameras"][0].pop("camera"),
    lambda e: e["cameras"][0].update(image=-1),
    lambda e: e["cameras"][0].update(visibility="a.png"),
    lambda e: e["cameras"][0]["visibility"].update(uri="/etc/passwd"),
    lambda e: e["cameras"][0]["camera"].update(model="EQUIRECTANGULAR"),
    lambda e: e["cameras"][0]["camera"].update(width=0),
    lambda e: e["cameras"][0]["camera"].update(fx=0),
    lambda e: e["cameras"][0]["camera"].pop("cy"),
]
schema_check.run(lambda document: document["extensions"]["IBR_harmonised_texture"], BREAKS)
