# SPDX-License-Identifier: Apache-2.0
"""Evaluation against held-out photographs. The scores equal those of `ibr eval`."""

import json
import math
import pathlib
import tempfile
import unittest

import numpy as np
import support

import ibr
import ibr.author

# Keys of the report of `ibr eval`.
KEYS = {
    "psnr": "psnr",
    "ssim": "ssim",
    "flip": "flip",
    "coverage": "coverage",
    "coverage_tier0": "coverageTier0",
    "coverage_tier2": "coverageTier2",
    "psnr_covered": "psnrCovered",
    "ssim_covered": "ssimCovered",
    "psnr_gain": "psnrGain",
    "psnr_covered_gain": "psnrCoveredGain",
    "ms_ssim": "msSsim",
    "detail_energy": "detailEnergy",
    "detail_correlation": "detailCorrelation",
    "torn_tiles": "tornTiles",
}


class Evaluate(support.DeviceTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.truth = ibr.author.held_out(support.COURT / "truth")
        cls.renderer = ibr.Renderer(ibr.load_scene(support.SCENE), (192, 144), device=cls.device)

    @classmethod
    def tearDownClass(cls):
        del cls.renderer
        super().tearDownClass()

    def check(self, scores, expected):
        for name, key in KEYS.items():
            value, other = scores[name], expected[key]
            if other is None:
                self.assertFalse(math.isfinite(value), name)
            else:
                self.assertAlmostEqual(value, other, places=9, msg=name)

    def test_scores_equal_those_of_the_program(self):
        renderer = ibr.Renderer(ibr.load_scene(support.SCENE), (192, 144))  # the program's choice of device
        evaluation = ibr.author.evaluate(renderer, self.truth, fit_gain=True)
        report = json.loads((support.DATA / "evaluation.json").read_text(encoding="utf-8"))
        self.assertEqual([view.name for view in evaluation.views], [view["name"] for view in report["views"]])
        for view, expected in zip(evaluation.views, report["views"]):
            self.check({name: getattr(view.scores, name) for name in KEYS}, expected)
            self.assertEqual(view.scores.worst_tile.x, expected["worstTile"]["x"])
        self.check(evaluation.mean, report["mean"])
        self.assertGreater(evaluation.mean["psnr"], 15)
        self.assertFalse(support.started_children())

    def test_names_select_views_and_progress_may_cancel(self):
        reports = []
        evaluation = ibr.author.evaluate(
            self.renderer, self.truth, names=["truth01.png"], progress=lambda *report: reports.append(report)
        )
        self.assertEqual([view.name for view in evaluation.views], ["truth01.png"])
        self.assertEqual(reports, [("evaluating", 0, 1)])
        self.assertTrue(math.isnan(evaluation.views[0].scores.psnr_gain))
        with self.assertRaises(ValueError):
            ibr.author.evaluate(self.renderer, self.truth, names=["photo0000.jpg"])
        call = lambda: ibr.author.evaluate(self.renderer, self.truth, progress=lambda *report: False)
        self.assertEqual(support.code_of(call), ibr.ErrorCode.CANCELLED)

    def test_pixels_of_a_mask_do_not_count(self):
        with tempfile.TemporaryDirectory() as folder:
            mask = np.full((144, 192), 255, np.uint8)
            mask[:, :96] = 0
            support.Image.fromarray(mask).save(pathlib.Path(folder, "truth00.png"))
            masked = ibr.author.held_out(support.COURT / "truth", masks=folder)
            np.testing.assert_array_equal(masked.mask(0), mask)
            self.assertIsNone(masked.mask(1))
            scores = ibr.author.evaluate(self.renderer, masked).views[0].scores
        whole = ibr.author.evaluate(self.renderer, self.truth).views[0].scores
        self.assertNotEqual(scores.psnr, whole.psnr)
        self.assertTrue(math.isnan(scores.torn_tiles))


class HeldOut(unittest.TestCase):
    def test_photographs_have_the_size_of_their_cameras(self):
        truth = ibr.author.held_out(support.COURT / "truth")
        self.assertEqual([image.name for image in truth.images], ["truth00.png", "truth01.png"])
        camera = truth.images[0].camera
        photograph = truth.photograph(0)
        self.assertEqual(photograph.shape, (camera.intrinsics.height, camera.intrinsics.width, 3))
        np.testing.assert_array_equal(photograph, support.picture_of(support.COURT / "truth/images/truth00.png"))
        with self.assertRaises(IndexError):
            truth.photograph(2)

    def test_a_folder_without_a_model_is_named(self):
        with self.assertRaisesRegex(FileNotFoundError, "images"):
            ibr.author.held_out(support.COURT / "truth" / "images")


if __name__ == "__main__":
    support.main()
