#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Writes lantern.gltf and lantern.bin beside itself: a lantern post at the origin, 3.4 m high, y up. The post consists
# of flat-shaded frustums of regular prisms.
import json
import math
import pathlib
import struct

# Frustums: number of corners, then height and radius of the bottom and of the top, metres.
IRON = [(8, 0.00, 0.22, 0.10, 0.22), (8, 0.10, 0.17, 0.45, 0.11), (8, 0.45, 0.13, 0.52, 0.13),
        (8, 0.52, 0.065, 2.55, 0.045), (8, 2.55, 0.09, 2.62, 0.09), (4, 2.62, 0.06, 2.70, 0.15),
        (4, 3.12, 0.27, 3.16, 0.27), (4, 3.16, 0.25, 3.34, 0.05), (6, 3.34, 0.03, 3.42, 0.01)]
GLASS = [(4, 2.70, 0.14, 3.12, 0.22)]


def frustum(corners, low, low_radius, high, high_radius):
    """Yields triangles of three corners each, counter-clockwise from outside."""
    def ring(height, radius):
        angles = [2 * math.pi * (i + 0.5) / corners for i in range(corners)]
        return [(radius * math.cos(a), height, -radius * math.sin(a)) for a in angles]

    bottom, top = ring(low, low_radius), ring(high, high_radius)
    for i in range(corners):
        j = (i + 1) % corners
        yield bottom[i], bottom[j], top[j]
        yield bottom[i], top[j], top[i]
        if 0 < i < corners - 1:
            yield top[0], top[i], top[j]
            yield bottom[0], bottom[j], bottom[i]


def normal(a, b, c):
    u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.sqrt(sum(x * x for x in n))
    return tuple(x / length for x in n)


data, views, accessors, primitives = b"", [], [], []


def accessor(values, kind):
    """Appends vectors of floats and returns the index of their accessor."""
    global data
    raw = b"".join(struct.pack("<3f", *v) for v in values)
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(raw), "target": 34962})
    entry = {"bufferView": len(views) - 1, "componentType": 5126, "count": len(values), "type": "VEC3"}
    if kind == "POSITION":
        stored = [struct.unpack("<3f", struct.pack("<3f", *v)) for v in values]
        entry["min"], entry["max"] = [min(c) for c in zip(*stored)], [max(c) for c in zip(*stored)]
    accessors.append(entry)
    data += raw
    return len(accessors) - 1


for material, parts in enumerate((IRON, GLASS)):
    triangles = [t for part in parts for t in frustum(*part)]
    positions = [corner for t in triangles for corner in t]
    normals = [n for t in triangles for n in [normal(*t)] * 3]
    primitives.append({"attributes": {"POSITION": accessor(positions, "POSITION"), "NORMAL": accessor(normals, "NORMAL")},
                       "material": material})

gltf = {
    "asset": {"version": "2.0", "generator": "make.py", "copyright": "Apache-2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"name": "lantern", "mesh": 0}],
    "meshes": [{"name": "lantern", "primitives": primitives}],
    "materials": [
        {"name": "iron", "pbrMetallicRoughness": {"baseColorFactor": [0.16, 0.19, 0.18, 1], "roughnessFactor": 0.7}},
        {"name": "glass", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.45, 0.3, 1], "metallicFactor": 0},
         "emissiveFactor": [0.75, 0.62, 0.35]},
    ],
    "accessors": accessors,
    "bufferViews": views,
    "buffers": [{"uri": "lantern.bin", "byteLength": len(data)}],
}
here = pathlib.Path(__file__).resolve().parent
(here / "lantern.bin").write_bytes(data)
(here / "lantern.gltf").write_text(json.dumps(gltf, indent=1) + "\n")
