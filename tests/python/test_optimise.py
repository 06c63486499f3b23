# SPDX-License-Identifier: Apache-2.0
"""The optimiser, on a scene and on two pictures."""

import pathlib
import tempfile
import unittest

import numpy as np
import support

import ibr
import ibr.author

UNITS = ibr.ALIGNMENT_UNITS_PER_PIXEL


def texture(height, width, seed):
    """A smooth random picture."""
    grid = np.random.default_rng(seed).uniform(0, 255, (height // 8 + 2, width // 8 + 2, 3))
    y, x = np.arange(height) / 8, np.arange(width) / 8
    y0, x0 = y.astype(int), x.astype(int)
    v, u = (y - y0)[:, None, None], (x - x0)[None, :, None]
    above = grid[y0][:, x0] * (1 - u) + grid[y0][:, x0 + 1] * u
    below = grid[y0 + 1][:, x0] * (1 - u) + grid[y0 + 1][:, x0 + 1] * u
    return np.rint(above * (1 - v) + below * v).astype(np.uint8)


class Align(unittest.TestCase):
    """Two pictures that show the same, one shifted by two pixels; the matches do not know the shift."""

    def setUp(self):
        whole = texture(64, 80, 1)
        self.pictures = [whole[:, :72].copy(), whole[:, 2:74].copy()]
        self.middle = 4
        points = np.array([[16, 16], [56, 16], [56, 48], [16, 48], [36, 32]], np.int32) * UNITS
        self.positions = [points, points.copy()]
        self.triangles = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], np.uint32)

    def test_points_move_until_the_pictures_agree(self):
        options = ibr.AlignmentOptions(method=ibr.AlignmentMethod.CPU, rigidity=0)
        mesh = ibr.align(self.pictures, self.positions, self.triangles.astype(np.int64), options)
        self.assertEqual([positions.dtype for positions in mesh.positions], 2 * [np.int32])
        np.testing.assert_array_equal(mesh.triangles, self.triangles)
        self.assertGreater(mesh.summary.final_ecc, mesh.summary.initial_ecc)
        self.assertEqual(len(mesh.summary.final_star_ecc), 5)
        apart = (mesh.positions[1] - mesh.positions[0])[self.middle] / UNITS
        self.assertLess(apart[0], -0.5)  # towards the shift

    def test_fixed_points_stay(self):
        mesh = ibr.align(
            self.pictures, self.positions, self.triangles, fixed=np.ones(5, np.uint8), unevaluated=self.triangles[:0]
        )
        np.testing.assert_array_equal(mesh.positions[1], self.positions[1])

    def test_progress_is_reported_and_may_cancel(self):
        reports = []
        ibr.align(self.pictures, self.positions, self.triangles, progress=lambda *report: reports.append(report))
        self.assertTrue(reports)
        self.assertIsInstance(reports[0][0], str)

        def stop(stage, done, total):
            return False

        call = lambda: ibr.align(self.pictures, self.positions, self.triangles, progress=stop)
        self.assertEqual(support.code_of(call), ibr.ErrorCode.CANCELLED)

        def fail(stage, done, total):
            raise ZeroDivisionError(stage)

        with self.assertRaises(ZeroDivisionError):
            ibr.align(self.pictures, self.positions, self.triangles, progress=fail)

    def test_arrays_of_a_wrong_type_or_shape_are_refused(self):
        for positions in ([p / 2 for p in self.positions], [p.tolist() for p in self.positions], None):
            with self.assertRaises(TypeError):
                ibr.align(self.pictures, positions, self.triangles)
        for triangles in (self.triangles[:, :2], self.triangles.ravel(), self.triangles.astype(int) - 1):
            with self.assertRaises(ValueError):
                ibr.align(self.pictures, self.positions, triangles)
        with self.assertRaises(ValueError):
            ibr.align([picture[:, :, 0] for picture in self.pictures], self.positions, self.triangles)

    def test_meshes_that_do_not_fit_are_invalid_input(self):
        compute = ibr.AlignmentOptions(method=ibr.AlignmentMethod.COMPUTE)
        for call in (
            lambda: ibr.align(self.pictures[:1], self.positions[:1], self.triangles),
            lambda: ibr.align(self.pictures, self.positions, self.triangles + np.uint32(3)),
            lambda: ibr.align(self.pictures, [p - 9999 for p in self.positions], self.triangles),
            lambda: ibr.align(self.pictures, self.positions, self.triangles, compute),
            lambda: ibr.align(self.pictures, self.positions, self.triangles, ibr.AlignmentOptions(instances=1)),
        ):
            self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)

    def test_a_device_gives_the_mesh_of_the_processor(self):
        device = support.device()
        options = ibr.AlignmentOptions(method=ibr.AlignmentMethod.COMPUTE)
        on_device = ibr.align(self.pictures, self.positions, self.triangles, options, device=device)
        on_cpu = ibr.align(
            self.pictures, self.positions, self.triangles, options.replace(method=ibr.AlignmentMethod.CPU)
        )
        np.testing.assert_array_equal(on_device.positions[1], on_cpu.positions[1])
        self.assertEqual(device.validation_messages, 0)


class OptimiseScene(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.output = pathlib.Path(folder.name, "sharper")

    def test_a_scene_is_optimised_into_another_folder(self):
        stages = set()
        report = ibr.author.optimise_scene(
            support.SCENE, self.output, cells=[0], threads=1, progress=lambda stage, done, total: stages.add(stage)
        )
        self.assertEqual([cell.cell for cell in report.cells], [0])
        self.assertGreaterEqual(report.cells[0].summary.final_ecc, report.cells[0].summary.initial_ecc)
        self.assertTrue(stages)
        self.assertEqual(ibr.validate_scene_files(self.output), ())
        before, after = ibr.load_scene(support.SCENE), ibr.load_scene(self.output)
        self.assertEqual(after.cells[0].mesh.match[0].shape, before.cells[0].mesh.match[0].shape)

    def test_an_exception_of_the_progress_leaves_no_scene(self):
        def fail(stage, done, total):
            raise ValueError(stage)

        with self.assertRaises(ValueError):
            ibr.author.optimise_scene(support.SCENE, self.output, progress=fail)
        self.assertFalse((self.output / "scene.gltf").exists())

    def test_faults_of_the_input_are_errors(self):
        self.assertEqual(
            support.code_of(lambda: ibr.author.optimise_scene(support.DATA / "none", self.output)), ibr.ErrorCode.IO
        )
        for arguments in ({"cells": [1000]}, {"alignment": ibr.AlignmentOptions(decay=2)}):
            call = lambda: ibr.author.optimise_scene(support.SCENE, self.output, **arguments)
            self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)
        with self.assertRaises(TypeError):
            ibr.author.optimise_scene(support.SCENE, self.output, cells="all")


if __name__ == "__main__":
    support.main()
