# SPDX-License-Identifier: Apache-2.0
"""Builds: reports, progress, and builds that are stopped."""

import logging
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import support

import ibr
import ibr.author

INTERRUPTED = """
import pathlib, signal, sys
import ibr.author
signal.signal(signal.SIGINT, signal.default_int_handler)  # the test may run with SIGINT ignored
photographs, model, output = map(pathlib.Path, sys.argv[1:])
options = ibr.author.BuildOptions(
    photographs=photographs, model=model, output=output, depth=ibr.author.DepthSearch.FINE, threads=1)
ibr.author.build(options)
"""


class Build(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.options = ibr.author.BuildOptions(
            photographs=support.COURT / "images",
            model=support.COURT / "sparse",
            output=self.folder / "scene",
            exclude=[f"photo{i:04}.jpg" for i in range(4, 8)],
            depth=ibr.author.DepthSearch.FAST,
        )

    def is_scene_written(self):
        return (self.options.output / "scene.gltf").exists()

    def test_a_report_lists_what_was_built(self):
        report = ibr.author.build(self.options, on_prediction=lambda prediction: True)
        scene = ibr.load_scene(self.options.output)
        self.assertEqual(len(scene.nodes), 4)
        self.assertEqual([cell.members for cell in report.cells][0], ("photo0000.jpg", "photo0001.jpg"))
        self.assertEqual(len(report.cells), len(scene.cells))
        self.assertEqual(len(report.backdrops), 4)
        self.assertEqual(report.poses, self.options.model)
        self.assertEqual(report.prediction.photographs, 4)
        self.assertIsInstance(report.cells[0].matcher, ibr.author.MatchMethod)
        again = ibr.author.build(self.options)
        self.assertTrue(all(cell.cached for cell in again.cells))

    def test_progress_names_stages_and_counts_up(self):
        reports = []
        ibr.author.build(self.options, progress=lambda *report: reports.append(report))
        self.assertGreater(len({stage for stage, _, _ in reports}), 1)
        for stage, done, total in reports:
            self.assertIsInstance(stage, str)
            self.assertTrue(total == 0 or done <= total)

    def test_false_cancels_and_the_next_build_resumes(self):
        for stop in (False, np.bool_(False)):
            goes_on = lambda stage, done, total: stop if "cells" in stage and done > 0 else None
            call = lambda: ibr.author.build(self.options, progress=goes_on)
            self.assertEqual(support.code_of(call), ibr.ErrorCode.CANCELLED)
            self.assertFalse(self.is_scene_written())
        report = ibr.author.build(self.options)
        self.assertTrue(any(cell.cached for cell in report.cells))
        self.assertEqual(ibr.validate_scene_files(self.options.output), ())

    def test_exceptions_of_callbacks_cancel_and_are_raised(self):
        for error in (ZeroDivisionError, KeyboardInterrupt, SystemExit):

            def fail(*arguments, error=error):
                raise error

            for callback in ("progress", "on_prediction"):
                with self.assertRaises(error):
                    ibr.author.build(self.options, **{callback: fail})
                self.assertFalse(self.is_scene_written())

    def test_a_prediction_may_end_the_build(self):
        predictions = []

        def refuse(prediction):
            predictions.append(prediction)
            return False

        report = ibr.author.build(self.options, on_prediction=refuse)
        self.assertEqual(predictions[0].photographs, 4)
        self.assertGreater(report.prediction.seconds, 0)
        self.assertEqual(report.cells, ())
        self.assertFalse(self.is_scene_written())

    def test_an_alarm_s_handler_stops_a_build_without_callbacks(self):
        def stop(number, frame):
            raise TimeoutError

        previous = signal.signal(signal.SIGALRM, stop)
        self.addCleanup(signal.signal, signal.SIGALRM, previous)
        signal.setitimer(signal.ITIMER_REAL, 0.01)
        with self.assertRaises(TimeoutError):
            ibr.author.build(self.options)
        self.assertFalse(self.is_scene_written())  # the handler ran during the build

    def test_ctrl_c_stops_a_build_and_leaves_no_scene(self):
        scene = self.folder / "interrupted"
        arguments = [support.DATA / "large/images", support.DATA / "large/sparse", scene]
        with subprocess.Popen([sys.executable, "-c", INTERRUPTED, *arguments], stderr=subprocess.PIPE, text=True) as run:
            while not scene.exists() and run.poll() is None:
                time.sleep(0.01)
            self.assertIsNone(run.poll(), "the build ended before it could be interrupted")
            run.send_signal(signal.SIGINT)
            error = run.stderr.read()
        self.assertEqual(run.returncode, -signal.SIGINT)
        self.assertIn("KeyboardInterrupt", error)
        self.assertFalse((scene / "scene.gltf").exists())

    def test_one_build_runs_at_a_time(self):
        builds, may_go_on = threading.Event(), threading.Event()

        def wait(*report):
            builds.set()
            may_go_on.wait()

        first = threading.Thread(target=ibr.author.build, args=[self.options], kwargs={"progress": wait})
        first.start()
        builds.wait()
        other = self.options.replace(output=self.folder / "other")
        self.assertEqual(support.code_of(lambda: ibr.author.build(other)), ibr.ErrorCode.UNSUPPORTED)
        may_go_on.set()
        first.join()
        self.assertTrue(self.is_scene_written())

    def test_messages_go_to_the_logger(self):
        (self.folder / "masks").mkdir()
        options = self.options.replace(masks=self.folder / "masks")
        with self.assertLogs("ibr", logging.WARNING) as logs:
            ibr.author.build(options)
        self.assertIn("have no mask", "\n".join(logs.output))

    def test_faults_of_the_input_are_errors(self):
        missing = self.folder / "none"
        for changes, code in (
            ({"photographs": missing}, ibr.ErrorCode.IO),
            ({"model": missing}, ibr.ErrorCode.IO),
            ({"output": None}, ibr.ErrorCode.INVALID_INPUT),
            ({"backdrop_spacing": 3}, ibr.ErrorCode.INVALID_INPUT),
            ({"memory": float("nan")}, ibr.ErrorCode.INVALID_INPUT),
            ({"exclude": ["unknown.jpg"]}, ibr.ErrorCode.INVALID_INPUT),
        ):
            call = lambda: ibr.author.build(self.options.replace(**changes))
            self.assertEqual(support.code_of(call), code, changes)
        with self.assertRaises(TypeError):
            ibr.author.build("photographs")


class OtherInput(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_models_are_written_and_read(self):
        model = ibr.author.read_colmap_model(support.COURT / "sparse")
        self.assertEqual(len(model.images), 8)
        self.assertEqual(model.track_positions.shape[1], 3)
        ibr.author.write_colmap_model(ibr.author.PosedModel(model.images[:2]), self.folder / "model")
        again = ibr.author.read_colmap_model(self.folder / "model")
        self.assertEqual([image.name for image in again.images], ["photo0000.jpg", "photo0001.jpg"])
        self.assertEqual(again.images[0].camera.intrinsics, model.images[0].camera.intrinsics)
        self.assertFalse(again.images[0].distorted)
        call = lambda: ibr.author.read_colmap_model(self.folder / "none")
        self.assertEqual(support.code_of(call), ibr.ErrorCode.IO)

    def test_a_folder_s_photographs_are_found(self):
        found = ibr.author.scan_photograph_folder(support.COURT / "images")
        self.assertEqual((len(found.pictures), found.unreadable), (8, ()))
        call = lambda: ibr.author.scan_photograph_folder(self.folder / "none")
        self.assertEqual(support.code_of(call), ibr.ErrorCode.IO)

    def test_a_panorama_is_split(self):
        panorama = support.Image.new("RGB", (128, 64), (10, 120, 200))
        panorama.save(self.folder / "panorama.png")
        options = ibr.author.SplitOptions(input=self.folder / "panorama.png", output=self.folder / "faces", size=16)
        reports = []
        report = ibr.author.split_panoramas(options, progress=lambda *now: reports.append(now))
        self.assertEqual((report.panoramas, report.pictures, report.size), (1, 6, 16))
        self.assertTrue(reports)
        files = sorted((self.folder / "faces/images").iterdir())
        self.assertEqual(ibr.author.read_picture(files[0])[0, 0].tolist(), [10, 120, 200])

    def test_an_exception_stops_a_harmonised_model(self):
        def fail(*report):
            raise ZeroDivisionError

        options = ibr.author.HtmBuildOptions(
            mesh=support.FIGURE / "mesh.ply",
            model=support.FIGURE / "sparse",
            images=support.FIGURE / "images",
            output=self.folder / "model",
        )
        with self.assertRaises(ZeroDivisionError):
            ibr.author.build_htm(options, progress=fail)
        self.assertFalse((self.folder / "model/model.gltf").exists())

    def test_a_picture_that_is_missing_or_damaged_is_an_error(self):
        (self.folder / "damaged.png").write_bytes(b"\x89PNG\r\n\x1a\n")
        for name in ("missing.png", "damaged.png"):
            with self.assertRaisesRegex(ibr.Error, name):
                ibr.author.read_picture(self.folder / name)


if __name__ == "__main__":
    support.main()
