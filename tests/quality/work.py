# SPDX-License-Identifier: Apache-2.0
"""One set in the output folder: it is built, judged, and its result kept, so that the same command goes on where it was
stopped."""
import pathlib
import shutil

from figures import added, quotient, summary
from files import ROOT, UNSUPPORTED, Failure, digest, model_names, names_in, read_json, say, write_json, write_text
from page import pair, text_of
from program import check_run, without
from sets import LEFT_OUT, PANORAMA_BASELINES, RENDER_OPTIONS, SPLIT_OPTIONS


class Work:
    """One set in the output folder."""

    def __init__(self, of, configuration, program, options):
        self.of, self.configuration, self.program = of, configuration, program
        self.out, self.reuse_scenes = options.output, options.reuse_scenes
        self.base = ROOT / "examples/photographs" if of.bundled else options.datasets
        self.scene = self.out / "scenes" / of.name
        self.stamp = self.out / "scenes" / f"{of.name}.json"
        self.pictures = self.out / "pictures" / of.name
        self.pictures_of = self.out / "pictures" / f"{of.name}.txt"  # whose they are
        self.log = self.out / "logs" / f"{of.name}.log"
        self.run_name = f"{configuration.hash()}-{program.hash}"
        self.result = self.out / "results" / self.run_name / f"{of.name}.json"

    def has_pictures(self):
        """Returns true where the pictures in OUT are of this run: another run replaces them."""
        return self.pictures_of.is_file() and self.pictures_of.read_text(encoding="utf-8") == self.run_name

    def is_there(self):
        return self.base is not None and (self.base / self.of.photographs).is_dir()

    def left_out(self):
        rule = LEFT_OUT[self.of.left_out]
        return rule(names_in(self.base / self.of.photographs)) if self.of.left_out != "none" else []

    def build_words(self):
        option, poses = self.of.poses
        names = self.left_out()
        return [*self.configuration.build, option, str(self.base / poses), *(["--exclude", *names] if names else [])]

    def build(self):
        """Returns what the build cost; builds where no finished scene is kept, and goes on where one was stopped."""
        key = {"rules": digest(self.configuration.build), "leftOut": self.left_out(), "program": self.program.hash}
        stamp = read_json(self.stamp)
        if stamp and stamp["done"] and (stamp["key"] == key or self.reuse_scenes and
                                        {**stamp["key"], "program": 0} == {**key, "program": 0}):
            return stamp
        if stamp is None and self.scene.exists():
            raise Failure(f"{self.scene}: is there, but not of this script; remove it")
        if stamp and (stamp["done"] or stamp["key"] != key) and self.scene.exists():
            shutil.rmtree(self.scene)
            stamp = None
        # A build that was killed has not said what it took.
        before = stamp or {"seconds": 0, "cpuSeconds": 0}
        write_json(self.stamp, {"key": key, "done": False, "seconds": None, "cpuSeconds": None})
        report = self.log.with_suffix(".build.json")
        words = ["build", str(self.base / self.of.photographs), "-o", str(self.scene), "-q", "--json", str(report),
                 *self.build_words()]
        run = self.program.run(words, self.log)
        stamp = {"key": key, "done": run.code == 0, "seconds": added(before["seconds"], run.seconds),
                 "cpuSeconds": added(before["cpuSeconds"], run.cpu_seconds)}
        if run.code == 0:
            stamp["megapixels"] = (read_json(report) or {}).get("predicted", {}).get("megapixels")
            stamp["words"] = words
        write_json(self.stamp, stamp)
        check_run(run, "ibr build", self.log)
        return stamp

    def faces(self):
        """Splits the panoramas; returns the folder, and the names of the faces of those that are left out."""
        folder = self.out / "truth" / f"{self.of.name}-{digest(SPLIT_OPTIONS)}-{self.program.hash}"
        if not (folder / "sparse/images.txt").exists():
            option, poses = self.of.poses
            words = ["split", str(self.base / self.of.photographs), option, str(self.base / poses), "-o", str(folder),
                     *SPLIT_OPTIONS]
            check_run(self.program.run(words, self.log), "ibr split", self.log)
        stems = tuple(pathlib.PurePath(name).stem + "_" for name in self.left_out())
        return folder, [name for name in model_names(folder / "sparse") if name.startswith(stems)]

    def truth_words(self):
        folder, names = self.faces() if self.of.judged == "faces" else (self.base / self.of.truth, self.left_out())
        words = ["--truth", str(folder), *(["--views", *names] if names else [])]
        if self.of.depth_unit and "--truth-depth" in self.program.eval_help:
            words += ["--truth-depth", str(folder / "depth"), "--depth-unit", str(self.of.depth_unit)]
        return words

    def evaluate(self):
        """Returns the report of `ibr eval`, and the seconds it took. Baselines are left away where the program has none
        for such photographs (panoramas)."""
        report = self.log.with_suffix(".eval.json")
        options = self.program.eval_words(self.configuration.evaluation)
        self.remove_pictures()
        words = ["eval", str(self.scene), "-o", str(self.pictures), "-q", "--json", str(report), *self.truth_words()]
        run = self.program.run([*words, *options], self.log)
        if run.code == UNSUPPORTED and "--baselines" in options:
            few = ["--baselines", *PANORAMA_BASELINES] if "gathered" in self.program.eval_help else []
            options = [*without(options, "--baselines"), *few]
            run = self.program.run([*words, *options], self.log)
        check_run(run, "ibr eval", self.log)
        return read_json(report), run.seconds, options

    def remove_pictures(self):
        self.pictures_of.unlink(missing_ok=True)
        shutil.rmtree(self.pictures, ignore_errors=True)

    def render(self):
        self.remove_pictures()
        run = self.program.run(["render", str(self.scene), "-o", str(self.pictures), "-q", *RENDER_OPTIONS], self.log)
        check_run(run, "ibr render", self.log)
        return run.seconds

    def finished(self):
        """The result that an earlier run left of this configuration, program and scene, or None."""
        result, stamp = read_json(self.result), read_json(self.stamp)
        builder = stamp["key"]["program"] if self.reuse_scenes and stamp else self.program.hash
        return result if result and result["build"]["program"] == builder else None

    def do(self):
        say(f"{self.of.name}: build, {len(self.left_out())} photographs left out")
        stamp = self.build()
        cost = quotient(stamp["cpuSeconds"], stamp.get("megapixels"))
        say(f"{self.of.name}: built, {text_of(stamp['seconds'], 0)} s, {text_of(cost, 1)} CPU seconds a megapixel; "
            f"{self.of.judged}")
        result = {"set": self.of.name, "leftOut": self.left_out(),
                  "build": {"program": stamp["key"]["program"], "seconds": stamp["seconds"],
                            "cpuSeconds": stamp["cpuSeconds"], "megapixels": stamp.get("megapixels"),
                            "cpuSecondsPerMegapixel": cost}}
        if self.of.judged == "pictures":
            result.update(views=[], evalSeconds=self.render(), evalOptions=[])
        else:
            report, seconds, options = self.evaluate()
            result.update(views=report["views"], device=report.get("device"), evalSeconds=seconds, evalOptions=options)
        write_text(self.pictures_of, self.run_name)
        write_json(self.result, result)
        now = summary(result).get("now")
        if now:
            say(f"{self.of.name}: PSNR / SSIM {pair(now['mean'])}, {result['evalSeconds']:.0f} s")
        return result
