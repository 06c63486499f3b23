#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the plans of photographing.md, seen from above, into libibr/docs/pictures: capture-NAME.svg."""
import math
import pathlib

PICTURES = pathlib.Path(__file__).resolve().parent.parent / "pictures"
INK, VIEW, CELL = "#1f2933", "#3178c6", "#f0b429"


class Plan:
    def __init__(self, width, height):
        self.size, self.parts = (width, height), []

    def camera(self, x, y, *directions, reach=46, fov=62):
        """A capture site with views; directions in degrees, 0 is right, 90 is up. Without directions: a panorama."""
        for direction in directions:
            corners = [(x + reach * math.cos(math.radians(direction + side)), y - reach * math.sin(math.radians(direction + side)))
                       for side in (-fov / 2, fov / 2)]
            points = " ".join(f"{a:.1f},{b:.1f}" for a, b in [(x, y), *corners])
            self.parts.append(f'<polygon points="{points}" fill="{VIEW}" fill-opacity=".16" stroke="{VIEW}" stroke-width=".8"/>')
        if not directions:
            self.parts.append(f'<circle cx="{x}" cy="{y}" r="{reach}" fill="{VIEW}" fill-opacity=".12" stroke="{VIEW}" stroke-width=".8"/>')
        self.parts.append(f'<circle cx="{x}" cy="{y}" r="4" fill="{INK}"/>')

    def cell(self, *corners):
        points = " ".join(f"{x},{y}" for x, y in corners)
        self.parts.insert(0, f'<polygon points="{points}" fill="{CELL}" fill-opacity=".25" stroke="{CELL}"/>')

    def line(self, x1, y1, x2, y2, dash=""):
        self.parts.append(f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{INK}" stroke-dasharray="{dash}"/>')

    def text(self, x, y, words, anchor="middle"):
        self.parts.append(f'<text x="{x}" y="{y}" font-family="sans-serif" font-size="13" fill="{INK}" text-anchor="{anchor}">{words}</text>')

    def span(self, x1, x2, y, words):
        self.line(x1, y, x2, y)
        for x in (x1, x2):
            self.line(x, y - 4, x, y + 4)
        self.text((x1 + x2) / 2, y + 17, words)

    def write(self, name):
        width, height = self.size
        body = "\n".join(self.parts)
        (PICTURES / f"capture-{name}.svg").write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">\n'
            f'<rect width="{width}" height="{height}" fill="#ffffff"/>\n{body}\n</svg>\n')


def overlap():
    plan = Plan(560, 190)
    plan.line(20, 24, 540, 24)
    plan.text(540, 17, "nearest surface of interest", "end")
    distance = 110
    for i in range(9):
        plan.camera(190 + i * distance // 5, 24 + distance, 90, reach=distance / math.cos(math.radians(33)), fov=66)
    plan.span(190, 190 + distance // 5, 152, "d / 5")
    plan.line(60, 24, 60, 24 + distance, "4 3")
    plan.text(54, 82, "d", "end")
    plan.write("overlap")


def path():
    plan = Plan(560, 150)
    for i in range(7):
        x, y = 60 + 72 * i, 80 + 14 * math.sin(i)
        plan.camera(x, round(y, 1), 0, 90, -90, reach=40)
    plan.text(280, 140, "a path: at each step one view ahead and views to the sides")
    plan.write("path")


def grid():
    plan = Plan(560, 350)
    step, rows = 130, []
    for row in range(3):
        rows.append([(85 + step * (column + row % 2 / 2), 60 + round(step * row * 0.8)) for column in range(4 - row % 2)])
    for upper, lower in ((rows[0], rows[1]), (rows[2], rows[1])):
        for i, corner in enumerate(lower):
            plan.cell(upper[i], upper[i + 1], corner)
            if i + 1 < len(lower):
                plan.cell(lower[i], lower[i + 1], upper[i + 1])
    for row in rows:
        for x, y in row:
            plan.camera(x, y, *range(0, 360, 45), reach=42)
    plan.span(rows[2][0][0], rows[2][1][0], 324, "0.5 to 2 m on foot")
    plan.write("grid")


def panoramas():
    plan = Plan(560, 270)
    corners = [(90, 60), (220, 60), (350, 60), (155, 170), (285, 170), (415, 170)]
    for a, b, c in ((0, 1, 3), (1, 3, 4), (1, 2, 4), (2, 4, 5)):
        plan.cell(corners[a], corners[b], corners[c])
    for x, y in corners:
        plan.camera(x, y, reach=22)
    plan.text(280, 245, "panoramas: one picture at each corner of the grid")
    plan.write("panoramas")


def ring():
    plan = Plan(560, 330)
    x, y, radius = 280, 160, 118
    plan.parts.append(f'<circle cx="{x}" cy="{y}" r="26" fill="{CELL}" fill-opacity=".5" stroke="{INK}"/>')
    for i in range(16):
        angle = 2 * math.pi * i / 16
        plan.camera(round(x + radius * math.cos(angle), 1), round(y - radius * math.sin(angle), 1), math.degrees(angle) + 180,
                    reach=128, fov=30)
    plan.text(280, 318, "an object: 16 views around it, and a second ring higher or lower")
    plan.write("ring")


if __name__ == "__main__":
    for draw in (overlap, path, grid, panoramas, ring):
        draw()
