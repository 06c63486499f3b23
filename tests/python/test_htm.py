# SPDX-License-Identifier: Apache-2.0
"""Harmonised models: their data, and pictures that equal those of `ibr render`."""

import gc
import pathlib
import tempfile
import unittest

import numpy as np
import support

import ibr
import ibr.author


class ModelData(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = ibr.load_htm_model(support.MODEL)

    def test_arrays_have_the_documented_shapes(self):
        vertices, cameras = len(self.model.mesh.positions), len(self.model.cameras)
        self.assertEqual(cameras, 8)
        self.assertEqual(self.model.mesh.positions.shape, (vertices, 3))
        self.assertLess(self.model.mesh.triangles.max(), vertices)
        self.assertEqual((self.model.members.shape, self.model.members.dtype), ((vertices,), np.uint64))
        complements = self.model.complements
        self.assertEqual((complements.shape, complements.dtype), ((cameras, cameras, vertices, 2), np.float32))
        self.assertTrue((complements[3, 3] == 0).all())
        self.assertGreater(np.abs(complements).max(), 0)
        with self.assertRaises(ValueError):
            complements[0, 1, 0] = 1

    def test_arrays_outlive_their_model(self):
        model = ibr.load_htm_model(support.MODEL)
        arrays = model.complements, model.mesh.positions, model.members
        copies = [array.copy() for array in arrays]
        del model
        gc.collect()
        for array, copy in zip(arrays, copies):
            np.testing.assert_array_equal(array, copy)

    def test_a_built_model_has_no_faults_and_keeps_its_source(self):
        self.assertEqual(ibr.validate_htm_model(self.model), ())
        self.assertEqual(ibr.validate_htm_model_files(support.MODEL), ())
        before = ibr.unoptimised_htm_model(self.model)
        self.assertIsNone(before.complements)
        np.testing.assert_array_equal(before.mesh.positions, self.model.source_mesh.positions)

    def test_missing_models_and_sequences_are_io_errors(self):
        for load in (ibr.load_htm_model, ibr.load_htm_sequence):
            self.assertEqual(support.code_of(lambda: load(support.DATA / "none")), ibr.ErrorCode.IO)

    def test_an_index_of_frames_is_read(self):
        with tempfile.TemporaryDirectory() as folder:
            index = pathlib.Path(folder, "sequence.json")
            index.write_text('{"version": 1, "fps": 12.5, "frames": ["a", "b"]}', encoding="utf-8")
            sequence = ibr.load_htm_sequence(folder)
        self.assertEqual((sequence.fps, sequence.frames), (12.5, (pathlib.Path("a"), pathlib.Path("b"))))


class ModelPictures(support.DeviceTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.model = ibr.load_htm_model(support.MODEL)
        cls.views = ibr.author.read_transforms(support.DATA / "model_views.json").images
        cls.renderer = ibr.HtmRenderer(cls.model, ibr.author.read_htm_picture, device=cls.device)

    @classmethod
    def tearDownClass(cls):
        del cls.renderer
        super().tearDownClass()

    def test_pictures_equal_those_of_the_program(self):
        renderer = ibr.HtmRenderer(self.model, ibr.author.read_htm_picture)  # the program's choice of device
        for view in self.views:
            picture = renderer.render(view.camera)
            expected = support.picture_of(support.DATA / "model_pictures" / view.name)
            np.testing.assert_array_equal(picture, expected)
        self.assertFalse(support.started_children())

    def test_settings_and_frames_before_come_with_the_plan(self):
        camera = self.views[0].camera
        plan = self.renderer.plan(camera, ibr.HtmSettings(background=[0, 0, 1], exclude=0b1))
        self.assertNotIn(0, [planned.camera for planned in plan.cameras])
        corner = self.renderer.render(plan)[0, 0]
        self.assertEqual(corner.tolist(), [0, 0, 255, 0])
        slow = ibr.HtmSettings(smoothing_seconds=1e9)
        second = self.renderer.plan(self.views[1].camera, slow, dt_seconds=0.1, previous=self.renderer.plan(camera))
        first_cameras = [planned.camera for planned in self.renderer.plan(camera).cameras]
        self.assertEqual([planned.camera for planned in second.cameras], first_cameras)

    def test_pictures_of_other_sizes_follow_each_other(self):
        camera = self.views[0].camera
        before = self.renderer.render(camera)
        small = camera.replace(intrinsics=camera.intrinsics.resized(64, 64))
        self.assertEqual(self.renderer.render(small).shape, (64, 64, 4))
        np.testing.assert_array_equal(self.renderer.render(camera), before)

    def test_photographs_alone_are_enough(self):
        photographs = lambda model, camera: ibr.author.read_htm_picture(model, camera)[0]
        renderer = ibr.HtmRenderer(self.model, photographs, device=self.device)
        self.assertEqual(renderer.render(self.views[0].camera).shape, (128, 128, 4))

    def test_an_exception_of_the_pictures_is_raised(self):
        def refuse(model, camera):
            raise KeyError(camera)

        with self.assertRaises(KeyError):
            ibr.HtmRenderer(self.model, refuse, device=self.device)

    def test_pictures_of_a_wrong_type_or_size_are_refused(self):
        def made(picture):
            return lambda: ibr.HtmRenderer(self.model, lambda model, camera: picture, device=self.device)

        right, grey = np.zeros((128, 128, 3), np.uint8), np.zeros((128, 128), np.uint8)
        for picture in (None, right.tolist(), right.astype(float), (right, "none"), (right, grey.astype(float))):
            with self.assertRaises(TypeError):
                made(picture)()
        for picture in (grey, (right,), (right, right)):
            with self.assertRaises(ValueError):
                made(picture)()
        for picture in (right[1:], (right, grey[1:])):
            self.assertEqual(support.code_of(made(picture)), ibr.ErrorCode.INVALID_INPUT)

    def test_plans_of_other_models_and_wrong_views_are_invalid_input(self):
        other = ibr.HtmRenderer(ibr.load_htm_model(support.MODEL), ibr.author.read_htm_picture, device=self.device)
        plan = other.plan(self.views[0].camera)
        panorama = ibr.Camera(ibr.Intrinsics(ibr.CameraModel.EQUIRECTANGULAR, 64, 32))
        for call in (
            lambda: self.renderer.render(plan),
            lambda: self.renderer.plan(self.views[0].camera, previous=plan),
            lambda: self.renderer.render(panorama),
            lambda: self.renderer.plan(self.views[0].camera, ibr.HtmSettings(gamma=0)),
            lambda: self.renderer.plan(self.views[0].camera, dt_seconds=float("nan")),
        ):
            self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)
        with self.assertRaises(TypeError):
            self.renderer.render(None)


if __name__ == "__main__":
    support.main()
