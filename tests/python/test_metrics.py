# SPDX-License-Identifier: Apache-2.0
"""Metrics of arrays."""

import math
import unittest

import numpy as np
import support

import ibr


class Metrics(unittest.TestCase):
    def setUp(self):
        self.picture = np.random.default_rng(1).integers(20, 230, (60, 80, 3), dtype=np.uint8)
        self.brighter = self.picture + np.uint8(5)

    def test_psnr_is_that_of_its_definition(self):
        self.assertAlmostEqual(ibr.psnr(self.picture, self.brighter), 20 * math.log10(255 / 5))
        self.assertEqual(ibr.psnr(self.picture, self.picture), math.inf)

    def test_a_mask_selects_the_pixels_that_count(self):
        other = self.picture.copy()
        other[:30] += 5
        mask = np.zeros((60, 80), np.uint8)
        mask[:30] = 1
        self.assertAlmostEqual(ibr.psnr(self.picture, other, mask), 20 * math.log10(255 / 5))
        self.assertEqual(ibr.psnr(self.picture, other, 1 - mask), math.inf)
        self.assertTrue(math.isnan(ibr.psnr(self.picture, other, np.zeros_like(mask))))
        self.assertEqual(ibr.delta_e(self.picture, other, 1 - mask), 0)

    def test_equal_pictures_are_alike_by_every_metric(self):
        same = self.picture
        self.assertAlmostEqual(ibr.ssim(same, same), 1)
        self.assertEqual(ibr.flip(same, same), 0)
        self.assertEqual(ibr.delta_e(same, same), 0)
        self.assertAlmostEqual(ibr.detail(same, same).energy, 1)
        self.assertAlmostEqual(ibr.detail(same, same).correlation, 1)
        self.assertEqual(ibr.difference(same, same).largest, 0)
        self.assertTrue(math.isnan(ibr.ms_ssim(same, same)))  # too small

    def test_differences_count_levels_and_pixels(self):
        difference = ibr.difference(self.picture, self.brighter, threshold=4)
        self.assertEqual((difference.largest, difference.mean_absolute, difference.share_above), (5, 5, 1))
        self.assertEqual(ibr.difference(self.picture, self.brighter, threshold=5).share_above, 0)

    def test_the_map_of_flip_has_the_picture_s_size(self):
        flip_map = ibr.flip_map(self.picture, self.brighter)
        self.assertEqual((flip_map.shape, flip_map.dtype), ((60, 80), np.float32))
        self.assertAlmostEqual(float(flip_map.mean()), ibr.flip(self.picture, self.brighter), places=5)
        self.assertGreater(flip_map.min(), 0)

    def test_scores_of_a_view_leave_holes_out_of_the_covered_scores(self):
        prediction = np.dstack([self.brighter, np.full((60, 80), 255, np.uint8)])
        prediction[:, 40:] = 0
        scores = ibr.score_view(prediction, self.picture, fit_gain=True)
        self.assertEqual((scores.coverage, scores.coverage_tier0), (0.5, 0.5))
        self.assertAlmostEqual(scores.psnr_covered, 20 * math.log10(255 / 5))
        self.assertLess(scores.psnr, scores.psnr_covered)
        self.assertGreater(scores.psnr_covered_gain, scores.psnr_covered)
        self.assertGreaterEqual(scores.worst_tile.x, 32)
        self.assertTrue(math.isnan(ibr.score_view(prediction, self.picture).psnr_gain))
        mask = np.zeros((60, 80), np.uint8)
        mask[:, :40] = 255
        self.assertEqual(ibr.score_view(prediction, self.picture, mask=mask).coverage, 1)

    def test_views_of_larger_arrays_are_accepted(self):
        self.assertEqual(
            ibr.psnr(self.picture[::2, ::-1], self.brighter[::2, ::-1]),
            ibr.psnr(self.picture[::2, ::-1].copy(), self.brighter[::2, ::-1].copy()),
        )

    def test_arrays_of_another_type_are_type_errors(self):
        for other in (self.picture.astype(np.float32), self.picture.astype(np.int64), self.picture.tolist(), None):
            with self.assertRaises(TypeError):
                ibr.psnr(self.picture, other)
        with self.assertRaises(TypeError):
            ibr.psnr(self.picture, self.brighter, np.ones((60, 80), bool))
        with self.assertRaises(TypeError):
            ibr.psnr(self.picture, self.brighter, "mask")

    def test_arrays_of_another_shape_are_value_errors(self):
        for other in (self.picture[:, :, 0], self.picture[:, :, :2], self.picture[None], np.zeros((0, 0, 3), np.uint8)):
            with self.assertRaises(ValueError):
                ibr.psnr(self.picture, other)
        with self.assertRaises(ValueError):
            ibr.psnr(self.picture, self.brighter, self.picture)

    def test_pictures_of_different_sizes_are_invalid_input(self):
        for call in (
            lambda: ibr.psnr(self.picture, self.picture[1:]),
            lambda: ibr.psnr(self.picture, self.brighter, np.ones((59, 80), np.uint8)),
            lambda: ibr.score_view(self.picture, self.picture),
            lambda: ibr.flip(self.picture, self.brighter, 0),
        ):
            self.assertEqual(support.code_of(call), ibr.ErrorCode.INVALID_INPUT)


if __name__ == "__main__":
    support.main()
