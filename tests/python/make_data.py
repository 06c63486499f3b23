# SPDX-License-Identifier: Apache-2.0
"""Builds the scene and the harmonised model that the tests use, and writes the views that `ibr render` renders."""

import json
import shutil

import numpy as np
import support

import ibr
import ibr.author


def frame_of(name, camera):
    """A frame of transforms.json."""
    k = camera.intrinsics
    return {
        "file_path": name,
        "w": k.width,
        "h": k.height,
        "fl_x": k.fx,
        "fl_y": k.fy,
        "cx": k.cx,
        "cy": k.cy,
        "camera_model": "PINHOLE",
        "transform_matrix": camera.pose.matrix.tolist(),
    }


def write_views(file, cameras):
    frames = [frame_of(f"view{i}.png", camera) for i, camera in enumerate(cameras)]
    file.write_text(json.dumps({"frames": frames}), encoding="utf-8")


def between(a, b, share):
    """A pose on the way from one camera to another, with the rotation of the first."""
    return a.pose.replace(position=np.asarray(a.pose.position) * (1 - share) + np.asarray(b.pose.position) * share)


def main():
    for folder in (support.SCENE, support.MODEL):
        shutil.rmtree(folder, ignore_errors=True)
    ibr.author.build(
        ibr.author.BuildOptions(
            photographs=support.COURT / "images", model=support.COURT / "sparse", output=support.SCENE
        )
    )
    scene = ibr.load_scene(support.SCENE)
    intrinsics = ibr.Intrinsics.from_fov(160, 120, 0.9)
    members = [scene.nodes[i].camera for i in scene.cells[0].members]
    write_views(
        support.DATA / "views.json",
        [
            ibr.Camera(intrinsics, members[0].pose),
            ibr.Camera(intrinsics, between(members[0], members[1], 0.4)),
            ibr.Camera(intrinsics, between(members[0], members[1], 1.2)),
        ],
    )

    options = ibr.author.HtmOptions(faces=600, adjust_rounds=1, rounds=1)
    ibr.author.build_htm(
        ibr.author.HtmBuildOptions(
            mesh=support.FIGURE / "mesh.ply",
            model=support.FIGURE / "sparse",
            images=support.FIGURE / "images",
            masks=support.FIGURE / "masks",
            output=support.MODEL,
            optimise=options,
        )
    )
    cameras = [entry.camera for entry in ibr.load_htm_model(support.MODEL).cameras]
    write_views(
        support.DATA / "model_views.json",
        [cameras[0], ibr.Camera(cameras[0].intrinsics, between(cameras[0], cameras[1], 0.1))],
    )


if __name__ == "__main__":
    main()
