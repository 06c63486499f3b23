# SPDX-License-Identifier: Apache-2.0
"""Cameras, and the values that all functions take: immutable, checked, and equal where their fields are."""

import math
import pathlib
import unittest

import numpy as np
import support

import ibr
import ibr.author


class Cameras(unittest.TestCase):
    def setUp(self):
        self.intrinsics = ibr.Intrinsics.from_fov(640, 480, 1.0)

    def test_field_of_view_gives_square_pixels_and_a_centred_principal_point(self):
        k = self.intrinsics
        self.assertEqual(k.model, ibr.CameraModel.PINHOLE)
        self.assertEqual((k.cx, k.cy), (320, 240))
        self.assertEqual(k.fx, k.fy)
        self.assertAlmostEqual(k.fy, 240 / math.tan(0.5))

    def test_tangents_give_the_edges_of_the_image(self):
        k = ibr.Intrinsics.from_tangents(100, 80, left=-1, right=0.5, up=0.75, down=-0.25)
        corners = k.project([[-1, 0.75, -1], [0.5, -0.25, -1]])
        np.testing.assert_allclose(corners, [[0, 0], [100, 80]], atol=1e-9)

    def test_projection_inverts_unprojection(self):
        pixels = np.random.default_rng(1).uniform(-50, 700, (20, 2))
        directions = self.intrinsics.unproject(pixels)
        self.assertEqual(directions.shape, (20, 3))
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1)
        np.testing.assert_allclose(self.intrinsics.project(5 * directions), pixels, atol=1e-9)
        self.assertEqual(self.intrinsics.unproject([320, 240]).tolist(), [0, 0, -1])
        self.assertTrue(np.isnan(self.intrinsics.project([0, 0, 1])).all())

    def test_wrong_shapes_of_pixels_are_value_errors(self):
        for pixels in ([1], [1, 2, 3], np.zeros((2, 3)), np.zeros((1, 2, 2)), 5):
            with self.assertRaises(ValueError):
                self.intrinsics.unproject(pixels)
        with self.assertRaises(ValueError):
            self.intrinsics.project(np.zeros((3, 2)))

    def test_numbers_out_of_range_are_errors_of_the_library(self):
        for call in (
            lambda: ibr.Intrinsics.from_fov(0, 480, 1),
            lambda: ibr.Intrinsics.from_fov(640, 480, math.nan),
            lambda: ibr.Intrinsics.from_fov(640, 480, 4),
            lambda: ibr.Intrinsics.from_tangents(10, 10, 1, -1, 1, -1),
            lambda: self.intrinsics.resized(0, 5),
            lambda: self.intrinsics.unproject([math.inf, 0]),
        ):
            self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)

    def test_pose_and_matrix_are_the_same_motion(self):
        half = math.sqrt(0.5)
        pose = ibr.Pose([1, 2, 3], [0, half, 0, half])  # a quarter turn to the left, about y
        np.testing.assert_allclose(pose.axis, [-1, 0, 0], atol=1e-12)
        np.testing.assert_allclose(pose.matrix @ [0, 0, -1, 1], [0, 2, 3, 1], atol=1e-12)
        again = ibr.Pose.from_matrix(pose.matrix)
        np.testing.assert_allclose(again.position, pose.position)
        np.testing.assert_allclose(again.rotation, pose.rotation, atol=1e-12)

    def test_matrices_that_are_not_rigid_are_refused(self):
        mirrored = np.diag([-1.0, 1, 1, 1])
        scaled = np.diag([2.0, 2, 2, 1])
        projective = np.eye(4)
        projective[3, 0] = 1
        unknown = np.eye(4)
        unknown[0, 3] = math.nan
        for matrix in (mirrored, scaled, projective, unknown, np.eye(3), np.full((4, 4), math.nan)):
            with self.assertRaises(ValueError):
                ibr.Pose.from_matrix(matrix)


class Values(unittest.TestCase):
    def test_fields_are_given_by_keyword_or_position(self):
        self.assertEqual(ibr.Intrinsics(width=3, height=2).width, 3)
        self.assertEqual(ibr.Intrinsics(ibr.CameraModel.PINHOLE, 3, 2).height, 2)
        self.assertEqual(ibr.Pose().rotation.tolist(), [0, 0, 0, 1])
        self.assertEqual(ibr.Intrinsics.__match_args__[:3], ("model", "width", "height"))

    def test_unknown_and_repeated_fields_are_type_errors(self):
        with self.assertRaisesRegex(TypeError, "no field maxcells"):
            ibr.RenderSettings(maxcells=3)
        with self.assertRaisesRegex(TypeError, "given twice"):
            ibr.Pose([0, 0, 0], position=[0, 0, 0])
        with self.assertRaisesRegex(TypeError, "2 fields, but 3"):
            ibr.Pose([0, 0, 0], [0, 0, 0, 1], 5)

    def test_values_of_a_wrong_type_are_type_errors_that_name_the_field(self):
        for field, value in (
            ("max_cells", "many"),
            ("max_cells", -1),
            ("max_cells", 2.5),
            ("composition", "cells"),
            ("composition", ibr.Morph.OURS),
            ("background", [0, 0]),
            ("background", "abc"),
            ("muted_cells", 5),
            ("floor", 3),
        ):
            with self.assertRaisesRegex(TypeError, f"RenderSettings.{field} cannot be"):
                ibr.RenderSettings(**{field: value})

    def test_values_are_immutable(self):
        settings = ibr.RenderSettings()
        with self.assertRaises(AttributeError):
            settings.max_cells = 3
        with self.assertRaises(AttributeError):
            settings.maxcells = 3
        with self.assertRaises(ValueError):
            settings.background[0] = 1
        self.assertIsInstance(settings.muted_cells, tuple)

    def test_replace_changes_a_copy(self):
        settings = ibr.RenderSettings(max_tier=1)
        changed = settings.replace(max_cells=3, muted_cells=[1, 2], floor=ibr.Floor(height=-1))
        self.assertEqual(settings.max_cells, ibr.RenderSettings().max_cells)
        self.assertEqual((changed.max_cells, changed.max_tier, changed.muted_cells), (3, 1, (1, 2)))
        self.assertEqual(changed.floor.height, -1)
        self.assertIsNone(changed.replace(floor=None).floor)
        with self.assertRaises(TypeError):
            settings.replace(cells=3)

    def test_equal_fields_make_equal_settings(self):
        self.assertEqual(ibr.RenderSettings(max_cells=3), ibr.RenderSettings(max_cells=3))
        self.assertNotEqual(ibr.RenderSettings(max_cells=3), ibr.RenderSettings())
        self.assertNotEqual(ibr.RenderSettings(), 3)
        self.assertEqual(ibr.Pose([1, 2, 3]), ibr.Pose([1, 2, 3]))
        self.assertNotEqual(ibr.Pose([1, 2, 3]), ibr.Pose([1, 2, 4]))
        camera = ibr.Camera(ibr.Intrinsics.from_fov(8, 6, 1.0), ibr.Pose([1, 2, 3]))
        self.assertEqual(camera, camera.replace())
        self.assertNotEqual(camera, camera.replace(pose=ibr.Pose([0, 2, 3])))
        self.assertEqual(ibr.author.BuildOptions(exclude=["a"]), ibr.author.BuildOptions(exclude=["a"]))
        self.assertNotEqual(ibr.author.BuildOptions(), ibr.author.BuildOptions(draft=True))

    def test_text_of_a_value_has_all_fields(self):
        text = repr(ibr.RenderSettings(max_cells=3))
        for field in ibr.RenderSettings.__match_args__:
            self.assertIn(f"{field}=", text)
        self.assertIn("max_cells=3", text)

    def test_presets_differ_by_the_kind_of_device(self):
        software = ibr.preset(ibr.Preset.BALANCED, ibr.DeviceKind.SOFTWARE)
        hardware = ibr.preset(ibr.Preset.BALANCED, ibr.DeviceKind.HARDWARE)
        self.assertNotEqual(software, hardware)
        self.assertEqual(software.composition, ibr.Composition.HYBRID)

    def test_paths_are_text_or_path_and_none_is_no_path(self):
        for path in ("a/b", pathlib.Path("a/b")):
            self.assertEqual(ibr.author.BuildOptions(photographs=path).photographs, pathlib.Path("a/b"))
        self.assertIsNone(ibr.author.BuildOptions().model)
        self.assertIsNone(ibr.author.BuildOptions(model=None).model)
        with self.assertRaises(TypeError):
            ibr.author.BuildOptions(model=5)

    def test_options_of_an_option_are_values_too(self):
        options = ibr.author.HtmBuildOptions(optimise=ibr.author.HtmOptions(faces=7))
        self.assertEqual(options.optimise.faces, 7)
        with self.assertRaises(TypeError):
            ibr.author.HtmBuildOptions(optimise=ibr.RenderSettings())


if __name__ == "__main__":
    support.main()
