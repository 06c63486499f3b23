# SPDX-License-Identifier: Apache-2.0
"""Plans of frames, without a device."""

import concurrent.futures
import math
import unittest

import numpy as np
import support

import ibr


class Plans(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = ibr.load_scene(support.SCENE)
        cls.planner = ibr.Planner(cls.scene)
        cls.settings = ibr.preset(ibr.Preset.BALANCED, ibr.DeviceKind.SOFTWARE)
        intrinsics = ibr.Intrinsics.from_fov(160, 120, 0.9)
        cls.view = ibr.Camera(intrinsics, cls.scene.nodes[0].camera.pose)

    def test_a_plan_names_cells_and_photographs_of_the_scene(self):
        plan = self.planner.plan(self.view, self.settings)
        self.assertIn(0, self.scene.cells[plan.cells[0].cell].members)
        self.assertEqual(plan.cells[0].extrapolation_distance, 0)
        blend = plan.cells[0].blend()
        self.assertEqual(blend.shape, (4,))
        self.assertAlmostEqual(blend.sum(), 1)
        self.assertEqual(plan.photographs[0].node, 0)
        self.assertAlmostEqual(sum(photograph.share for photograph in plan.photographs), 1)
        self.assertEqual(plan.settings, self.settings)
        self.assertEqual(plan.exposure.shape, (3,))
        self.assertGreater(plan.near_distance, 0)

    def test_settings_change_the_plan(self):
        plan = self.planner.plan(self.view, self.settings.replace(muted_cells=range(len(self.scene.cells))))
        self.assertEqual(plan.cells, ())
        self.assertGreater(plan.culled_by_muting, 0)
        cells_alone = self.planner.plan(self.view, self.settings.replace(composition=ibr.Composition.CELLS))
        self.assertEqual(cells_alone.photographs, ())

    def test_two_views_are_planned_together(self):
        right = self.view.replace(pose=self.view.pose.replace(position=self.view.pose.position + [0.06, 0, 0]))
        plan = self.planner.plan([self.view, right], self.settings)
        self.assertEqual(len(plan.views), 2)
        self.assertEqual(plan.cells[0].blend(1).shape, (4,))
        with self.assertRaises(IndexError):
            plan.cells[0].blend(2)

    def test_a_plan_continues_from_the_frame_before(self):
        first = self.planner.plan(self.view, self.settings)
        second = self.planner.plan(self.view, self.settings, dt_seconds=0.1, previous=first)
        self.assertEqual(second.cells[0].cell, first.cells[0].cell)
        other = ibr.Planner(ibr.load_scene(support.SCENE)).plan(self.view, self.settings)
        call = lambda: self.planner.plan(self.view, self.settings, previous=other)
        self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)

    def test_views_and_settings_out_of_range_are_invalid_input(self):
        unknown = self.view.replace(pose=ibr.Pose([math.nan, 0, 0]))
        longer = self.view.replace(pose=ibr.Pose([0, 0, 0], [0, 0, 0, 2]))
        panorama = ibr.Camera(ibr.Intrinsics(ibr.CameraModel.EQUIRECTANGULAR, 64, 32))
        for views in (unknown, longer, panorama, [], 3 * [self.view], ibr.Camera()):
            call = lambda: self.planner.plan(views, self.settings)
            self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)
        for changes in ({"vote_scale": 0}, {"texture_scale": math.nan}, {"order": ibr.DrawOrder.PAPER}):
            call = lambda: self.planner.plan(self.view, self.settings.replace(**changes))
            self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)

    def test_arguments_of_a_wrong_type_are_type_errors(self):
        for views, settings in ((5, self.settings), (["view"], self.settings), (self.view, None)):
            with self.assertRaises(TypeError):
                self.planner.plan(views, settings)
        with self.assertRaises(TypeError):
            ibr.Planner(None)

    def test_a_planner_keeps_its_scene_and_plans_on_many_threads(self):
        planner = ibr.Planner(ibr.load_scene(support.SCENE))
        expected = planner.plan(self.view, self.settings)
        with concurrent.futures.ThreadPoolExecutor(4) as threads:
            for plan in threads.map(lambda _: planner.plan(self.view, self.settings), range(16)):
                self.assertEqual([c.cell for c in plan.cells], [c.cell for c in expected.cells])
                np.testing.assert_array_equal(plan.cells[0].blend(), expected.cells[0].blend())


if __name__ == "__main__":
    support.main()
