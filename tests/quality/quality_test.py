#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the modules in this folder, without a program and photographs. The test of the contact sheet needs PIL, and
is skipped without PIL."""
import contextlib
import io
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
import figures  # noqa: E402
import files  # noqa: E402
import main  # noqa: E402
import page  # noqa: E402
import program as programs  # noqa: E402
import reference  # noqa: E402
import sets  # noqa: E402
import sheet  # noqa: E402

try:
    from PIL import Image
except ImportError:
    Image = None


def result(name, psnr, ssim=0.8, **more):
    return {"set": name, "views": [{"name": "a.jpg", "psnr": psnr, "ssim": ssim, **more}],
            "build": {"cpuSecondsPerMegapixel": None}}


def small(psnr, ssim=0.8):
    return reference.small_table({"lane": result("lane", psnr, ssim)}, "0")


class LeftOut(unittest.TestCase):
    def test_every_sixth_starts_with_the_fourth(self):
        rule = sets.LEFT_OUT["every sixth from the fourth on"]
        self.assertEqual(rule(list(range(18))), [3, 9, 15])
        self.assertEqual(rule(list(range(15))), [3, 9])
        self.assertEqual(rule([0, 1]), [])

    def test_names_are_sorted_and_only_of_photographs(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("b.jpg", "a.PNG", "LICENSE", "c.txt"):
                (pathlib.Path(folder) / name).touch()
            self.assertEqual(files.names_in(pathlib.Path(folder)), ["a.PNG", "b.jpg"])

    def test_names_of_a_model_may_have_spaces_and_images_no_points(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "images.txt").write_text(
                "# comment\n1 1 0 0 0 0 0 0 1 a b.jpg\n1 2 3\n2 1 0 0 0 0 0 0 1 c.jpg\n\n")
            self.assertEqual(files.model_names(pathlib.Path(folder)), ["a b.jpg", "c.jpg"])


class Losses(unittest.TestCase):
    def test_more_than_the_limit_is_reported_and_less_is_not(self):
        self.assertEqual(reference.losses(small(20), small(19.81)), [])
        self.assertEqual(reference.losses(small(20), small(19.8)), [])
        self.assertEqual(len(reference.losses(small(20), small(19.79))), 1)
        self.assertEqual(reference.losses(small(20, 0.8), small(20, 0.796)), [])
        self.assertIn("lane, now: ssim 0.7940", reference.losses(small(20, 0.8), small(20, 0.794))[0])

    def test_a_gain_is_no_loss(self):
        self.assertEqual(reference.losses(small(20), small(25)), [])

    def test_a_missing_set_is_a_loss_and_a_new_one_is_not(self):
        nothing = {"sets": {}}
        self.assertEqual(len(reference.losses(small(20), nothing)), 2)
        self.assertEqual(reference.losses(nothing, small(20)), [])

    def test_view_with_the_largest_loss(self):
        previous = {"a": {"psnr": 20}, "b": {"psnr": 20}, "gone": {"psnr": 30}, "none": {"psnr": None}}
        self.assertEqual(figures.largest_loss(previous, {"a": {"psnr": 21}, "b": {"psnr": 19}}), ("b", -1))
        self.assertIsNone(figures.largest_loss({}, {"a": {"psnr": 21}}))


class Tables(unittest.TestCase):
    def markdown(self, results, previous=None):
        about = {"program": {"hash": "0", "describe": "-"}, "configuration": "0", "failed": {}}
        return page.markdown(results, previous or {}, about)

    def test_missing_figures_leave_cells_empty(self):
        text = self.markdown({"hall-pano": result("hall-pano", 20), "lane": result("lane", None),
                              "empty": {"set": "empty", "views": [], "build": {"cpuSecondsPerMegapixel": 1.5}}})
        self.assertIn("| hall-pano | 1 | 20.00 / 0.800 |", text)
        self.assertIn("Images only: empty.", text)
        self.assertNotIn("None", text)
        self.assertNotIn("nan", text)

    def test_baselines_have_their_own_columns(self):
        scores = {"gathered": {"psnr": 22, "ssim": 0.9, "rightDepth": 0.75}, "lumigraph": None}
        lane = {"now": {"mean": {"psnr": 19, "ssim": 0.7}, "views": {"a.jpg": {"psnr": 20.5}}}}
        previous = {"program": "old", "configuration": "0", "sets": {"lane": lane}}
        text = self.markdown({"lane": result("lane", 20, baselines=scores, rightDepth=0.5)}, previous)
        self.assertIn("| lane | 1 | 19.00 / 0.700 | 20.00 / 0.800 | 22.00 / 0.900 | +1.00 |", text)
        self.assertIn("| lane | 0.500 · 0.750 |", text)
        self.assertIn("a.jpg -0.50", text)
        self.assertIn("now − old, dB", text)

    def test_means_ignore_views_without_the_figure(self):
        views = {"a": {"psnr": 20, "flip": None}, "b": {"psnr": 22, "flip": 0.5}}
        self.assertEqual(figures.mean_of(views), {"psnr": 21, "flip": 0.5})


class ContactSheet(unittest.TestCase):
    def test_worst_tiles_are_sorted_and_views_without_one_are_ranked_by_psnr(self):
        tile = {"x": 32, "y": 0, "meanSquared": 9000.0}
        found = sheet.worst_tiles({"one": result("one", 30, worstTile=tile), "two": result("two", 10),
                                   "three": result("three", 30)})
        self.assertEqual([(name, of) for name, _, of, _ in found], [("one", tile), ("two", None), ("three", None)])

    def test_without_tiles_the_lowest_psnr_comes_first(self):
        views = [{"name": name, "psnr": psnr} for name, psnr in (("a", 30), ("b", 10), ("c", 20), ("none", None))]
        found = sheet.worst_tiles({"lane": {"views": views}})
        self.assertEqual([(view, tile) for _, view, tile, _ in found], [("b", None), ("c", None), ("a", None)])
        self.assertAlmostEqual(found[1][3], 255 ** 2 / 100)

    @unittest.skipIf(Image is None, "PIL is missing")
    def test_the_tile_is_framed_in_prediction_truth_and_difference(self):
        tile = {"x": 16, "y": 8, "meanSquared": 100.0}
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "lane").mkdir()
            Image.new("RGB", (3 * 64, 48), "grey").save(folder / "lane/a.png")
            with contextlib.redirect_stderr(io.StringIO()):
                sheet.write_sheet(folder / "sheet.jpg", {"lane": result("lane", 20, worstTile=tile)}, folder)
            with Image.open(folder / "sheet.jpg") as picture:
                red, green, _ = picture.convert("RGB").split()
        # The row is 960 pixels wide, so the picture is five times as large, below 16 pixels of text.
        for part in range(3):
            area = (320 * part, 16, 320 * (part + 1), 16 + 5 * 48)
            levels = zip(red.crop(area).tobytes(), green.crop(area).tobytes())
            framed = [divmod(i, 320) for i, (r, g) in enumerate(levels) if r > g + 100]
            self.assertTrue(framed, part)
            rows, columns = zip(*framed)
            for value, expected in ((min(columns), 5 * 16), (min(rows), 5 * 8),
                                    (max(columns), 5 * (16 + sheet.TILE_PX)), (max(rows), 5 * (8 + sheet.TILE_PX))):
                self.assertAlmostEqual(value, expected, delta=4)
            self.assertNotIn((5 * (8 + 16), 5 * (16 + 16)), framed)


class ConfigurationHash(unittest.TestCase):
    def test_depends_on_options_but_not_on_selected_sets(self):
        def hash_of(*words):
            return sets.configuration_of(main.parse([*words])).hash()

        self.assertEqual(hash_of("/"), hash_of("/", "street"))
        different = {hash_of("/"), hash_of("/", "--build", "--max-size 9"), hash_of("/", "--eval", "--seams"),
                     hash_of("--small")}
        self.assertEqual(len(different), 4)

    def test_older_programs_get_only_supported_options(self):
        program = programs.Program.__new__(programs.Program)
        program.eval_help = "--baselines"
        self.assertEqual(program.eval_words(("--fit-gain", "--baselines", "lumigraph", "gathered", "--seams")),
                         ["--fit-gain", "--seams", "--baselines"])
        program.eval_help = "--baselines gathered"
        self.assertEqual(program.eval_words(sets.EVAL_OPTIONS), list(sets.EVAL_OPTIONS))


class CommandLine(unittest.TestCase):
    def run_script(self, *words):
        return subprocess.run([sys.executable, "-B", main.__file__, *words], capture_output=True, text=True,
                              check=False, env={"IBR": sys.executable})

    def test_exit_codes(self):
        self.assertEqual(self.run_script("--help").returncode, files.OK)
        self.assertEqual(self.run_script().returncode, files.COMMAND_LINE)
        self.assertEqual(self.run_script("/", "no-such-set").returncode, files.COMMAND_LINE)
        self.assertEqual(self.run_script("/no/such/folder").returncode, files.FILES)


if __name__ == "__main__":
    unittest.main()
