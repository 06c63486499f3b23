# SPDX-License-Identifier: Apache-2.0
"""The contact sheet sheet.jpg: the views with the worst tiles, each as prediction, truth and difference, with a red
frame round the tile. It needs PIL; without it the script says so and goes on."""
import math
import sys

from figures import is_number, views_of
from files import say

SHEET_VIEWS = 20
TILE_PX = 32


def worst_tiles(results):
    """(set, view, tile, mean squared error) of the views with the worst tiles. Where reports have no tiles: the views
    with the lowest PSNR, and None."""
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
    """Prediction, truth and difference, each with a frame round the tile, and a line of text above."""
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
    """Rows in two columns, the worst first."""
    try:
        from PIL import Image, ImageDraw  # pylint: disable=import-outside-toplevel
    except ImportError:
        say(f"no contact sheet: {sys.executable} has no PIL; install Debian's python3-pil, for /usr/bin/python3")
        return
    rows = []
    for name, view, tile, error in worst_tiles(results):
        path = pictures / name / (view.rsplit(".", 1)[0] + ".png")
        if path.is_file():
            with Image.open(path) as picture:
                text = f"{name} {view}: {'tile' if tile else 'view'} off by {math.sqrt(error):.0f} levels (RMS)"
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
