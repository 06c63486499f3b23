#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the input of `ibr htm build` for a textured ball: mesh, photographs, masks and their COLMAP model.

ball.py FOLDER: writes mesh.obj, images/NAME.png, masks/NAME.png and sparse/*.txt. check_pictures.py compares views of
the harmonised model with picture(). Exit code 77 if PIL is missing.
"""
import math
import pathlib
import sys

RADIUS, DISTANCE = 0.5, 2.5  # of the ball; from the cameras to its centre, the world's origin
WIDTH, HEIGHT = 160, 120  # of a photograph, px
FOV_Y = 2 * math.atan(0.68 / DISTANCE)
CAMERAS = 6
SUBDIVISIONS = 3


def multiply(p, q):
    """Product of two quaternions (w, x, y, z)."""
    a, b, c, d = p
    e, f, g, h = q
    return (a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e)


def rotate(q, v):
    w, x, y, z = q
    return multiply(multiply(q, (0, *v)), (w, -x, -y, -z))[1:]


def around(axis, angle):
    return (math.cos(angle / 2), *(math.sin(angle / 2) * a for a in axis))


def camera(index):
    """Position and rotation of a camera on the ring around the ball, in libibr's axes: y up, looking along -z."""
    elevation = -0.15 if index % 2 else 0.2
    rotation = multiply(around((0, 1, 0), 2 * math.pi * index / CAMERAS), around((1, 0, 0), -elevation))
    return tuple(-DISTANCE * a for a in rotate(rotation, (0, 0, -1))), rotation


def colour(point):
    """Texture of the ball: display-encoded red, green and blue, 0 to 255."""
    x, y, z = point
    return tuple(round(127 + 55 * math.sin(17 * x + 11 * y + 5 * c) + 45 * math.sin(13 * y - 19 * z + 3 * c))
                 for c in range(3))


def distance_of(position, direction):
    """Distance along a unit direction to the ball; None where the ray misses."""
    b = sum(p * d for p, d in zip(position, direction))
    discriminant = b * b - sum(p * p for p in position) + RADIUS * RADIUS
    return -b - math.sqrt(discriminant) if discriminant > 0 else None


def picture(position, rotation, width, height, step=1):
    """Yields (x, y, colour or None) of every step-th pixel of a view of the ball."""
    focal = height / 2 / math.tan(FOV_Y / 2)
    for y in range(0, height, step):
        for x in range(0, width, step):
            ray = ((x + 0.5 - width / 2) / focal, (height / 2 - y - 0.5) / focal, -1)
            length = math.sqrt(sum(a * a for a in ray))
            direction = [a / length for a in rotate(rotation, ray)]
            distance = distance_of(position, direction)
            yield x, y, None if distance is None else colour([p + distance * d for p, d in zip(position, direction)])


def sphere():
    """Vertices and triangles of a divided octahedron, counter-clockwise from outside."""
    points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    middles = {}

    def middle(a, b):
        key = (min(a, b), max(a, b))
        if key not in middles:
            total = [p + q for p, q in zip(points[a], points[b])]
            length = math.sqrt(sum(v * v for v in total))
            points.append(tuple(v / length for v in total))
            middles[key] = len(points) - 1
        return middles[key]

    for _ in range(SUBDIVISIONS):
        divided = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            divided += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = divided
    return [tuple(RADIUS * v for v in p) for p in points], faces


def main(folder):
    try:
        from PIL import Image  # pylint: disable=import-outside-toplevel
    except ImportError:
        print(f"{sys.executable} has no PIL; install Debian's python3-pil and use /usr/bin/python3", file=sys.stderr)
        return 77
    for name in ("images", "masks", "sparse"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    points, faces = sphere()
    (folder / "mesh.obj").write_text("".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points) +
                                     "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))
    focal = HEIGHT / 2 / math.tan(FOV_Y / 2)
    lenses, images = "", ""
    for index in range(CAMERAS):
        name = f"camera{index}.png"
        position, rotation = camera(index)
        photograph, mask = Image.new("RGB", (WIDTH, HEIGHT)), Image.new("L", (WIDTH, HEIGHT))
        for x, y, seen in picture(position, rotation, WIDTH, HEIGHT):
            if seen is not None:
                photograph.putpixel((x, y), seen)
                mask.putpixel((x, y), 255)
        photograph.save(folder / "images" / name)
        mask.save(folder / "masks" / name)
        # COLMAP maps world axes to camera axes with y down and z forward.
        w, x, y, z = multiply(rotation, (0, 1, 0, 0))
        back = (w, -x, -y, -z)
        shift = [-v for v in rotate(back, position)]
        lenses += f"{index + 1} PINHOLE {WIDTH} {HEIGHT} {focal!r} {focal!r} {WIDTH / 2} {HEIGHT / 2}\n"
        images += f"{index + 1} {' '.join(map(repr, (*back, *shift)))} {index + 1} {name}\n\n"
    (folder / "sparse/cameras.txt").write_text(lenses)
    (folder / "sparse/images.txt").write_text(images)
    (folder / "sparse/points3D.txt").write_text("# none\n")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(pathlib.Path(sys.argv[1])))
