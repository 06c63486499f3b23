# SPDX-License-Identifier: Apache-2.0
"""Contact sheet sheet.jpg: the views with the worst tiles, each as prediction, truth and difference, with a red frame
around the tile. Without PIL, the script prints a message and writes no sheet."""
import math
import sys

from figures import is_number, views_of
from files import say

SHEET_VIEWS = 20
TILE_PX = 32


def worst_tiles(results):
    """Returns (set, view, tile, mean squared error) of the views with the worst tiles. A view without a tile in its
    report has the mean squared error of its PSNR, and None as tile."""
    found = []
    for name, result in results.items():
        for view, scores in views_of(result, "now").items():
            tile = scores.get("worstTile") or {}
            error = tile.get("meanSquared")
            if not is_number(error):
                error, tile = 255 ** 2 * 10 ** (-scores["psnr"] / 10), None
            found.append((error, name, view, tile))
    found.sort(key=lambda each: (-each[0], each[1], each[2]))
    return [(name, view, tile, error) for error, name, view, tile in found[:SHEET_VIEWS]]


def sheet_row(image_module, draw_module, picture, tile, text, width):
    """Returns a row of prediction, truth and difference, with a frame around the tile in each, below a line of text."""
    scale = width / picture.width
    row = image_module.new("RGB", (width, round(picture.height * scale) + 16), "white")
    row.paste(picture.convert("RGB").resize((width, row.height - 16)), (0, 16))
    draw = draw_module.Draw(row)
    draw.text((4, 2), text, fill="black")
    for part in range(3 if tile else 0):
        x, y = (part * picture.width / 3 + tile["x"]) * scale, tile["y"] * scale + 16
        side = TILE_PX * scale
        draw.rectangle((x - 2, y - 2, x + side + 2, y + side + 2), outline="red", width=2)
    return row


def write_sheet(file, results, pictures):
    """Writes rows in two columns, sorted from worst to best."""
    try:
        from PIL import Image, ImageDraw  # pylint: disable=import-outside-toplevel
    except ImportError:
        say(f"no contact sheet: {sys.executable} has no PIL; install Debian's python3-pil and use /usr/bin/python3")
        return
    rows = []
    for name, view, tile, error in worst_tiles(results):
        path = pictures / name / (view.rsplit(".", 1)[0] + ".png")
        if path.is_file():
            with Image.open(path) as picture:
                area = "tile" if tile else "view"
                text = f"{name} {view}: RMS error of the {area} {math.sqrt(error):.0f} 8-bit levels"
                rows.append(sheet_row(Image, ImageDraw, picture, tile, text, 960))
    if not rows:
        return
    columns = [rows[i::2] for i in range(2)]
    height = max(sum(row.height + 6 for row in column) for column in columns)
    sheet = Image.new("RGB", (2 * 966, height), "white")
    for i, column in enumerate(columns):
        y = 0
        for row in column:
            sheet.paste(row, (966 * i, y))
            y += row.height + 6
    sheet.save(file, quality=88)
    say(f"contact sheet: {file}")
