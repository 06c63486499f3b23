#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the picture that an example has written.

check_pictures.py EXAMPLE FOLDER IBR: FOLDER has EXAMPLE.ppm, 01_offscreen.ppm and the folder scene; IBR is the program.
There are no stored pictures: a picture is compared with that of another example, of `ibr render`, or with what its
pixels must be. Exit code 1 if the picture is wrong, 77 if PIL is missing.
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

try:
    from PIL import Image, ImageChops, ImageStat
except ImportError:
    print(f"{sys.executable} has no PIL; install Debian's python3-pil and use /usr/bin/python3", file=sys.stderr)
    sys.exit(77)

import ball

WATER, FOG = (25.5, 89.25, 153), (204, 209.1, 216.75)  # colours of water.frag and 09_custom_pass.cpp
ARCH, PIER = (400, 100, 560, 220), (160, 320, 240, 400)  # boxes of the view of 01_offscreen: far and near surfaces
faults = []


def expect(holds, message):
    print(("" if holds else "WRONG: ") + message)
    if not holds:
        faults.append(message)


def largest_difference(a, b, box=None):
    """Largest difference of two pictures in a box, 8-bit levels."""
    return max(high for _, high in ImageChops.difference(a.crop(box), b.crop(box)).getextrema())


def differing(a, b, box):
    """Share of pixels in a box that differ by more than one 8-bit level."""
    bands = ImageChops.difference(a.crop(box), b.crop(box)).split()
    histogram = ImageChops.lighter(ImageChops.lighter(*bands[:2]), bands[2]).histogram()
    return sum(histogram[2:]) / sum(histogram)


def psnr(a, b):
    squares = ImageStat.Stat(ImageChops.difference(a, b)).sum2
    mean = sum(squares) / (3 * a.width * a.height)
    return math.inf if mean == 0 else 10 * math.log10(255 ** 2 / mean)


def psnr_of(pairs):
    """PSNR of pairs of colours."""
    pairs = list(pairs)
    mean = sum((p - q) ** 2 for a, b in pairs for p, q in zip(a, b)) / (3 * len(pairs))
    return math.inf if mean == 0 else 10 * math.log10(255 ** 2 / mean)


def share(a, b, colour, box):
    """Mean weight of a colour that was blended over picture a to give picture b."""
    product = square = 0
    for before, after in zip(a.crop(box).getdata(), b.crop(box).getdata()):
        for p, q, c in zip(before, after, colour):
            product += (q - p) * (c - p)
            square += (c - p) ** 2
    return product / square


def offscreen(picture, folder, program):
    scene = json.loads((folder / "scene/scene.gltf").read_text())
    graph = scene["extensions"]["IBR_image_graph"]
    first, second = (scene["nodes"][photograph["node"]] for photograph in graph["photographs"][:2])
    position = [(a + b) / 2 for a, b in zip(first["translation"], second["translation"])]
    key = {"time": 0, "position": position, "rotation": first["rotation"], "fovY": math.pi / 4}
    with tempfile.TemporaryDirectory() as temporary:
        poses = pathlib.Path(temporary, "path.json")
        poses.write_text(json.dumps({"version": 1, "size": picture.size, "fps": 1, "keys": [key]}))
        subprocess.run([program, "render", folder / "scene", "--poses", poses, "-o", temporary, "-q"], check=True)
        rendered = Image.open(pathlib.Path(temporary, "frame_0000.png")).convert("RGB")
        expect(largest_difference(picture, rendered) <= 1, "the picture is that of ibr render")
    expect(min(ImageStat.Stat(picture).stddev) > 20, "the picture shows something")


def adopted(picture, folder, _):
    expect(largest_difference(picture, first_picture(folder)) == 0, "an adopted device draws the same picture")


def into_a_frame(picture, folder, _):
    plain = first_picture(folder)
    # 01_offscreen fills small holes, in which sky shows here.
    expect(differing(picture, plain, (200, 20, 760, 300)) < 0.02, "above the water the place is unchanged")
    expect(differing(picture, plain, PIER) < 0.02, "the near pier hides the water behind it")
    weight = share(plain, picture, WATER, (300, 440, 660, 465))
    expect(abs(weight - 0.6) < 0.02, f"water covers the steps: weight {weight:.3f} is 0.6")
    for y in (10, 100, 200):
        height = 1 - (y + 0.5) / 270
        sky = [255 * (low + height * (high - low)) for low, high in zip((0.75, 0.85, 0.95), (0.25, 0.5, 0.85))]
        error = max(abs(p - s) for p, s in zip(picture.getpixel((40, y)), sky))
        expect(error <= 1.5, f"sky shows in the hole, row {y}")


def stereo(picture, folder, _):
    left, right = picture.crop((0, 0, 960, 540)), picture.crop((960, 0, 1920, 540))
    expect(psnr(left, first_picture(folder)) > 30, "the left eye sees what one eye sees")
    errors = {}
    for shift in range(-8, 9):
        box = (ARCH[0] + shift, ARCH[1], ARCH[2] + shift, ARCH[3])
        errors[shift] = sum(ImageStat.Stat(ImageChops.difference(left.crop(box), right.crop(ARCH))).mean)
    best = min(errors, key=errors.get)
    expect(1 <= best <= 3, f"the arch is {best} px farther left in the right eye: 652 px * 0.065 / 27.5 is 1.5")


def lantern(picture, folder, _):
    plain = first_picture(folder)
    near, far = (495, 340, 575, 500), (335, 310, 395, 440)
    outside = ImageChops.difference(picture, plain)
    for box in (near, far):
        outside.paste((0, 0, 0), box)
    expect(max(high for _, high in outside.getextrema()) <= 1, "the place is unchanged beside the posts")
    # Each post's axis: column, then first and last row. 0.95 allows for pixels of the post's own colour.
    for name, x, top, foot, least, most in (("near", 535, 356, 482, 0.95, 1), ("far", 365, 327, 424, 0.1, 0.9)):
        visible = differing(picture, plain, (x, top, x + 1, foot))
        expect(least <= visible <= most, f"{visible:.2f} of the {name} post can be seen: {least} to {most}")


def optimised(picture, _, __):
    before, after = picture.crop((0, 0, 640, 480)), picture.crop((640, 0, 1280, 480))
    expect(largest_difference(before, after) > 4, "the optimiser changes the picture")
    expect(psnr(before, after) > 22, "the pictures show the same view")
    # Aligned photographs blend into a sharper picture.
    old, new = (sum(ImageStat.Stat(ImageChops.difference(half, ImageChops.offset(half, 1, 0))).rms)
                for half in (before, after))
    expect(new > 0.98 * old, f"the optimised picture is not blurred: detail {new:.2f}, before {old:.2f}")


def harmonised(picture, _, __):
    position, rotation = ball.camera(0)
    turn = ball.around(ball.rotate(rotation, (0, 1, 0)), math.radians(20))
    position, rotation = ball.rotate(turn, position), ball.multiply(turn, rotation)
    middle, sine = (picture.width / 2, picture.height / 2), ball.RADIUS / ball.DISTANCE
    radius = sine / math.sqrt(1 - sine * sine) * picture.height / 2 / math.tan(ball.FOV_Y / 2)  # of the outline, px
    inside, outside = [], 0
    for x, y, colour in ball.picture(position, rotation, picture.width, picture.height, 2):
        distance = math.dist((x, y), middle) / radius
        if distance < 0.9:
            inside.append((picture.getpixel((x, y)), colour))
        elif distance > 1.03:
            outside += picture.getpixel((x, y)) != (0, 0, 0)
    value = psnr_of(inside)
    expect(value > 26, f"the ball looks as computed: PSNR {value:.1f} dB")
    expect(outside == 0, "nothing is drawn beside the ball")


def graph(picture, _, __):
    def colour(x, y):  # wallColour of 08_graph_in_code.cpp
        return (255 * (0.5 + 0.3 * math.sin(5 * x) * math.cos(4 * y)), 255 * (0.5 + 0.3 * math.sin(3 * x + 6 * y)),
                255 * (0.4 + 0.2 * math.cos(7 * y)))

    turn = ball.around((0, 1, 0), 0.05)
    focal = picture.height / 2 / math.tan(0.3)
    pairs = []
    for y in range(0, picture.height, 2):
        for x in range(0, picture.width, 2):
            ray = ((x + 0.5 - picture.width / 2) / focal, (picture.height / 2 - y - 0.5) / focal, -1)
            ray = ball.rotate(turn, ray)
            along = (-4 - 0.2) / ray[2]
            pairs.append((picture.getpixel((x, y)), colour(0.5 + along * ray[0], 0.3 + along * ray[1])))
    value = psnr_of(pairs)
    expect(value > 34, f"the wall looks as computed: PSNR {value:.1f} dB")


def custom_pass(picture, folder, _):
    hole = picture.crop((0, 0, 100, 200))
    expect(all(abs(p - f) <= 1 for extrema, f in zip(hole.getextrema(), FOG) for p in extrema), "holes are fog")
    plain = first_picture(folder)
    for name, box, distance in (("arch", ARCH, 27.5), ("pier", PIER, 16.3)):
        found, expected = share(plain, picture, FOG, box), 1 - math.exp(-distance / 30)
        expect(abs(found - expected) < 0.05, f"{found:.2f} of the {name}'s light is fog: {expected:.2f}")
    # Every pixel is a blend of place and fog, but for the lines of the image graph.
    lines, elsewhere = 0, 0
    for i, (place, pixel) in enumerate(zip(plain.getdata(), picture.getdata())):
        way = [f - p for f, p in zip(FOG, place)]
        weight = sum((q - p) * w for p, q, w in zip(place, pixel, way)) / sum(w * w for w in way)
        error = max(abs(p + weight * w - q) for p, q, w in zip(place, pixel, way))
        x, y = i % plain.width, i // plain.width
        if 390 <= x < 495 and 420 <= y < 510:  # the next two photographs
            lines += error > 20
        else:
            elsewhere += error > 4
    expect(lines > 100, f"lines of the image graph lie over the fog: {lines} pixels")
    expect(elsewhere == 0, f"nothing else does: {elsewhere} pixels")


CHECKS = {
    "01_offscreen": offscreen,
    "02_adopt_device": adopted,
    "03_into_a_frame": into_a_frame,
    "04_stereo": stereo,
    "05_lantern": lantern,
    "06_optimise_mesh": optimised,
    "07_harmonised_model": harmonised,
    "08_graph_in_code": graph,
    "09_custom_pass": custom_pass,
}


def first_picture(folder):
    return Image.open(folder / "01_offscreen.ppm")


def main(example, folder, program):
    folder = pathlib.Path(folder)
    CHECKS[example](Image.open(folder / f"{example}.ppm"), folder, program)
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in CHECKS:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
