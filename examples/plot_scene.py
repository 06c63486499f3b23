# SPDX-License-Identifier: Apache-2.0
"""Example of the Python package: draws the cameras of a scene from above, a short path with its pictures, and the depth
of a picture.

    python3 plot_scene.py SCENE PLOT.png

Needs the packages ibr (libibr/docs/python.md) and matplotlib.
"""

import sys

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes

import ibr

matplotlib.use("Agg")  # writes a file, without a window
import matplotlib.pyplot as plt  # noqa: E402

SIZE = (320, 240)  # px
STEPS = 5


def path_through(scene: ibr.Scene, cell: int) -> list[ibr.Camera]:
    """Cameras on the line between the first two photographs of a cell."""
    intrinsics = ibr.Intrinsics.from_fov(*SIZE, 0.9)
    first, last = (scene.nodes[member].camera.pose for member in scene.cells[cell].members[:2])
    return [
        ibr.Camera(intrinsics, first.replace(position=(1 - share) * first.position + share * last.position))
        for share in np.linspace(0, 1, STEPS)
    ]


def render(
    scene: ibr.Scene, cameras: list[ibr.Camera]
) -> tuple[list[npt.NDArray[np.uint8]], npt.NDArray[np.float32]]:
    """Pictures of all cameras, and the depth of the middle one; NaN where unknown."""
    renderer = ibr.Renderer(scene, SIZE, buffers=True)
    pictures, plan = [], None
    for camera in cameras:  # a plan continues from the frame before
        plan = renderer.plan(camera, dt_seconds=1 / 30, previous=plan)
        pictures.append(renderer.render(plan)[:, :, :3])
    depth = renderer.buffers(cameras[STEPS // 2]).depth
    return pictures, np.where(np.isfinite(depth), depth, np.nan)


def draw_cameras(axes: Axes, scene: ibr.Scene, cameras: list[ibr.Camera]) -> None:
    """Photographs as arrows along their viewing axes, seen from above, and the path."""
    positions = np.array([node.camera.pose.position for node in scene.nodes])
    directions = np.array([node.camera.pose.axis for node in scene.nodes])
    axes.quiver(positions[:, 0], positions[:, 2], directions[:, 0], directions[:, 2], angles="xy", color="grey")
    for cell in scene.cells:
        corners = positions[list(cell.members) + [cell.members[0]]]
        axes.plot(corners[:, 0], corners[:, 2], color="tab:blue", linewidth=1)
    path = np.array([camera.pose.position for camera in cameras])
    axes.plot(path[:, 0], path[:, 2], "o-", color="tab:red", markersize=3)
    axes.invert_yaxis()  # cameras look along -z: up in the plot
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_title("photographs, cells and path, from above")


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit("usage: plot_scene.py SCENE PLOT.png")
    scene = ibr.load_scene(sys.argv[1])
    if not scene.cells:
        sys.exit(f"{sys.argv[1]}: the scene has no cells")
    cameras = path_through(scene, 0)
    pictures, depth = render(scene, cameras)

    figure = plt.figure(figsize=(12, 7), layout="constrained")
    rows = figure.add_gridspec(2, STEPS)
    draw_cameras(figure.add_subplot(rows[0, :2]), scene, cameras)
    picture = figure.add_subplot(rows[0, 2:4])
    picture.imshow(pictures[STEPS // 2])
    picture.set_title("picture")
    axes = figure.add_subplot(rows[0, 4])
    shown = axes.imshow(depth, vmax=float(np.nanpercentile(depth, 95)))
    axes.set_title("depth")
    figure.colorbar(shown, ax=axes, location="bottom", label="world units")
    for step, image in enumerate(pictures):
        axes = figure.add_subplot(rows[1, step])
        axes.imshow(image)
        axes.set_axis_off()
    figure.savefig(sys.argv[2], dpi=80)
    print(f"{sys.argv[2]}: {len(scene.nodes)} photographs, {len(scene.cells)} cells, {STEPS} pictures")


if __name__ == "__main__":
    main()
