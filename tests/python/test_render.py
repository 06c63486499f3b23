# SPDX-License-Identifier: Apache-2.0
"""Pictures of a scene. They equal those of `ibr render`, without programs on the search path."""

import gc
import os
import shutil
import unittest

import numpy as np
import support

import ibr
import ibr.author

SIZE = (160, 120)


class Pictures(support.DeviceTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = ibr.load_scene(support.SCENE)
        cls.views = ibr.author.read_transforms(support.DATA / "views.json").images
        cls.renderer = ibr.Renderer(cls.scene, SIZE, buffers=True, stereo=True, device=cls.device)
        cls.cells = cls.renderer.settings.replace(
            composition=ibr.Composition.CELLS, solo_cells=[0], max_tier=0, alpha=ibr.AlphaContent.TIER
        )
        cls.cell_renderer = ibr.Renderer(cls.scene, SIZE, cls.cells, device=cls.device, buffers=True)

    @classmethod
    def tearDownClass(cls):
        del cls.renderer, cls.cell_renderer
        super().tearDownClass()

    def test_pictures_equal_those_of_the_program(self):
        self.assertIsNone(shutil.which("ibr"))
        self.assertFalse(os.path.exists(os.environ["PATH"]))
        for settings, folder in ((None, "pictures"), (self.cells, "cell_pictures")):
            renderer = ibr.Renderer(self.scene, SIZE, settings)  # the program's choice of device
            for view in self.views:
                picture = renderer.render(view.camera)
                self.assertEqual((picture.shape, picture.dtype), ((120, 160, 4), np.uint8))
                expected = support.picture_of(support.DATA / folder / view.name)
                np.testing.assert_array_equal(picture[:, :, :3], expected)
        self.assertFalse(support.started_children())

    def test_a_picture_at_a_photograph_shows_the_photograph(self):
        node = self.scene.nodes[0]
        renderer = ibr.Renderer(self.scene, (192, 144), device=self.device)
        photograph = ibr.author.read_picture(self.scene.folder / node.image_file)
        self.assertGreater(ibr.psnr(renderer.render(node.camera), photograph), 25)

    def test_a_plan_gives_the_picture_of_its_camera(self):
        for view in self.views:
            plan = self.renderer.plan(view.camera)
            np.testing.assert_array_equal(self.renderer.render(plan), self.renderer.render(view.camera))
            planned = ibr.Planner(self.scene).plan(view.camera, self.renderer.settings)
            np.testing.assert_array_equal(self.renderer.render(planned), self.renderer.render(view.camera))

    def test_pictures_of_other_sizes_follow_each_other(self):
        small = self.views[0].camera.replace(intrinsics=ibr.Intrinsics.from_fov(40, 30, 0.9))
        before = self.renderer.render(self.views[0].camera)
        self.assertEqual(self.renderer.render(small).shape, (30, 40, 4))
        np.testing.assert_array_equal(self.renderer.render(self.views[0].camera), before)

    def test_arrays_outlive_renderer_device_and_scene(self):
        renderer = ibr.Renderer(ibr.load_scene(support.SCENE), SIZE, buffers=True)
        picture, buffers = renderer.render(self.views[1].camera), renderer.buffers(self.views[1].camera)
        copies = picture.copy(), buffers.depth.copy()
        depth = buffers.depth
        self.assertTrue(np.shares_memory(depth, buffers.surface))
        del renderer, buffers
        gc.collect()
        np.testing.assert_array_equal(picture, copies[0])
        np.testing.assert_array_equal(depth, copies[1])
        picture[:] = 0  # an array of its own

    def test_a_renderer_keeps_its_scene_and_device(self):
        renderer = ibr.Renderer(ibr.load_scene(support.SCENE), SIZE, device=ibr.Device())
        gc.collect()
        self.assertEqual(renderer.render(self.views[0].camera).shape, (120, 160, 4))
        self.assertGreater(renderer.device_bytes, 0)

    def test_buffers_have_depth_tiers_and_weights(self):
        camera = self.views[1].camera
        buffers = self.cell_renderer.buffers(camera)
        for name in ("depth", "tier", "rank", "extrapolation", "spread", "uncertainty"):
            array = getattr(buffers, name)
            self.assertEqual((array.shape, array.dtype), ((120, 160), np.float32), name)
        self.assertEqual(buffers.weights.shape, (120, 160, 4))
        drawn = buffers.tier == 0
        alpha = self.cell_renderer.render(camera)[:, :, 3]
        np.testing.assert_array_equal(drawn, alpha > 0)
        self.assertGreater(np.count_nonzero(drawn), 2000)
        self.assertTrue((buffers.depth[drawn] > 0).all())
        self.assertTrue(np.isinf(buffers.depth[~drawn]).all())
        self.assertTrue((buffers.rank[drawn] == 0).all())
        np.testing.assert_allclose(buffers.weights[drawn].sum(axis=1), 1, atol=1e-3)

    def test_a_pair_shares_its_plan(self):
        left = self.views[1].camera
        right = left.replace(pose=left.pose.replace(position=left.pose.position + [0.05, 0, 0]))
        first, second = self.renderer.render_stereo([left, right])
        self.assertEqual((first.shape, second.shape), ((120, 160, 4), (120, 160, 4)))
        for eye, other, camera in ((first, second, left), (second, first, right)):
            alone = self.renderer.render(camera).astype(int)
            self.assertLess(np.abs(eye - alone).mean(), np.abs(other - alone).mean() / 4)
        plan = self.renderer.plan([left, right])
        np.testing.assert_array_equal(self.renderer.render_stereo(plan)[1], second)
        self.assertEqual(self.renderer.buffers(plan, 1).depth.shape, (120, 160))
        for call in (lambda: self.renderer.render(plan), lambda: self.renderer.render_stereo(left)):
            with self.assertRaises(ValueError):
                call()

    def test_plans_beyond_the_renderer_are_invalid_input(self):
        camera = self.views[0].camera
        wider = camera.replace(intrinsics=ibr.Intrinsics.from_fov(161, 120, 0.9))
        other = ibr.Planner(ibr.load_scene(support.SCENE)).plan(camera, self.renderer.settings)
        overlay = self.renderer.plan(camera, self.renderer.settings.replace(overlay=ibr.Overlay.WIREFRAME))
        for call in (
            lambda: self.renderer.render(wider),
            lambda: self.renderer.render(other),
            lambda: self.renderer.render(overlay),
            lambda: self.renderer.buffers(camera, 1),
            lambda: self.cell_renderer.render_stereo([camera, camera]),
            lambda: ibr.Renderer(self.scene, SIZE, device=self.device).buffers(camera),
        ):
            self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)

    def test_arguments_of_a_renderer_are_checked(self):
        for size in ((0, 10), (10, -1)):
            with self.assertRaises(ValueError):
                ibr.Renderer(self.scene, size, device=self.device)
        for arguments in ((None, SIZE), (self.scene, 5), (self.scene, (1, 2, 3)), (self.scene, SIZE, "balanced")):
            with self.assertRaises(TypeError):
                ibr.Renderer(*arguments, device=self.device)
        with self.assertRaises(TypeError):
            self.renderer.render("view")
        self.assertEqual(
            support.code_of(lambda: ibr.Renderer(self.scene, SIZE, device="no such device")),
            ibr.ErrorCode.UNSUPPORTED,
        )
        self.assertEqual(
            support.code_of(lambda: ibr.Renderer(self.scene, SIZE, device=self.device, budget_bytes=1)),
            ibr.ErrorCode.OUT_OF_MEMORY,
        )

    def test_photographs_are_streamed_within_a_budget(self):
        demand = ibr.memory_demand(self.scene).sum
        renderer = ibr.Renderer(self.scene, SIZE, device=self.device, budget_bytes=4 * demand)
        picture = renderer.render(self.views[1].camera)
        self.assertLessEqual(renderer.device_bytes, 4 * demand)
        np.testing.assert_array_equal(picture, self.renderer.render(self.views[1].camera))


class Devices(unittest.TestCase):
    def test_devices_are_described(self):
        for description in ibr.list_devices():
            self.assertTrue(description.name)
            self.assertIsInstance(description.kind, ibr.DeviceKind)
            self.assertEqual(len(description.api_version), 3)

    def test_a_device_has_the_kind_of_its_description(self):
        device = support.device()
        self.assertEqual(device.kind, ibr.preferred_device().kind)
        self.assertFalse(device.is_lost)
        self.assertIn(device.name, repr(device))

    def test_unknown_features_and_devices_are_errors(self):
        self.assertEqual(support.code_of(lambda: ibr.Device("no such device")), ibr.ErrorCode.UNSUPPORTED)
        support.device()
        call = lambda: ibr.Device(disabled_features="no such feature")
        self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)


if __name__ == "__main__":
    support.main()
