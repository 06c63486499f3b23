# SPDX-License-Identifier: Apache-2.0
"""Builds and evaluates one set in the output folder, and caches its result, so that the same command resumes a stopped
run."""
import pathlib
import shutil

from figures import quotient, sum_or_none, summary
from files import ROOT, UNSUPPORTED, Failure, digest, model_names, names_in, read_json, say, write_json, write_text
from page import pair, text_of
from program import check_run, without
from sets import LEFT_OUT, PANORAMA_BASELINES, RENDER_OPTIONS, SPLIT_OPTIONS


class Work:
    """One set in the output folder."""

    def __init__(self, photo_set, configuration, program, options):
        self.photo_set, self.configuration, self.program = photo_set, configuration, program
        self.out, self.reuse_scenes = options.output, options.reuse_scenes
        self.base = ROOT / "examples/photographs" if photo_set.bundled else options.datasets
        self.scene = self.out / "scenes" / photo_set.name
        self.stamp = self.out / "scenes" / f"{photo_set.name}.json"
        self.pictures = self.out / "pictures" / photo_set.name
        self.pictures_run = self.out / "pictures" / f"{photo_set.name}.txt"  # name of the run that wrote the pictures
        self.log = self.out / "logs" / f"{photo_set.name}.log"
        self.run_name = f"{configuration.hash()}-{program.hash}"
        self.result = self.out / "results" / self.run_name / f"{photo_set.name}.json"

    def has_pictures(self):
        """Returns true if this run wrote the pictures in OUT. Other runs replace them."""
        return self.pictures_run.is_file() and self.pictures_run.read_text(encoding="utf-8") == self.run_name

    def has_photographs(self):
        return self.base is not None and (self.base / self.photo_set.photographs).is_dir()

    def left_out(self):
        rule = LEFT_OUT[self.photo_set.left_out]
        return rule(names_in(self.base / self.photo_set.photographs)) if self.photo_set.left_out != "none" else []

    def build_words(self):
        option, poses = self.photo_set.poses
        names = self.left_out()
        return [*self.configuration.build, option, str(self.base / poses), *(["--exclude", *names] if names else [])]

    def build(self):
        """Returns the cost of the build. Builds unless a complete scene is cached, and resumes a stopped build."""
        key = {"rules": digest(self.configuration.build), "leftOut": self.left_out(), "program": self.program.hash}
        stamp = read_json(self.stamp)
        if stamp and stamp["done"] and (stamp["key"] == key or self.reuse_scenes and
                                        {**stamp["key"], "program": 0} == {**key, "program": 0}):
            return stamp
        if stamp is None and self.scene.exists():
            raise Failure(f"{self.scene}: exists, but was not written by this script; remove it")
        if stamp and (stamp["done"] or stamp["key"] != key) and self.scene.exists():
            shutil.rmtree(self.scene)
            stamp = None
        # A killed build leaves no cost: its stamp has None.
        before = stamp or {"seconds": 0, "cpuSeconds": 0}
        write_json(self.stamp, {"key": key, "done": False, "seconds": None, "cpuSeconds": None})
        report = self.log.with_suffix(".build.json")
        words = ["build", str(self.base / self.photo_set.photographs), "-o", str(self.scene), "-q", "--json",
                 str(report), *self.build_words()]
        run = self.program.run(words, self.log)
        stamp = {"key": key, "done": run.code == 0, "seconds": sum_or_none(before["seconds"], run.seconds),
                 "cpuSeconds": sum_or_none(before["cpuSeconds"], run.cpu_seconds)}
        if run.code == 0:
            stamp["megapixels"] = (read_json(report) or {}).get("predicted", {}).get("megapixels")
            stamp["words"] = words
        write_json(self.stamp, stamp)
        check_run(run, "ibr build", self.log)
        return stamp

    def faces(self):
        """Splits the panoramas. Returns the folder, and the face names of panoramas that are left out."""
        folder = self.out / "truth" / f"{self.photo_set.name}-{digest(SPLIT_OPTIONS)}-{self.program.hash}"
        if not (folder / "sparse/images.txt").exists():
            option, poses = self.photo_set.poses
            words = ["split", str(self.base / self.photo_set.photographs), option, str(self.base / poses), "-o",
                     str(folder), *SPLIT_OPTIONS]
            check_run(self.program.run(words, self.log), "ibr split", self.log)
        stems = tuple(pathlib.PurePath(name).stem + "_" for name in self.left_out())
        return folder, [name for name in model_names(folder / "sparse") if name.startswith(stems)]

    def truth_words(self):
        if self.photo_set.judged == "faces":
            folder, names = self.faces()
        else:
            folder, names = self.base / self.photo_set.truth, self.left_out()
        words = ["--truth", str(folder), *(["--views", *names] if names else [])]
        if self.photo_set.depth_unit and "--truth-depth" in self.program.eval_help:
            words += ["--truth-depth", str(folder / "depth"), "--depth-unit", str(self.photo_set.depth_unit)]
        return words

    def evaluate(self):
        """Returns the report of `ibr eval`, its time in seconds, and its options. If the program supports no baselines
        for the photographs (panoramas), the options are without them."""
        report = self.log.with_suffix(".eval.json")
        options = self.program.eval_words(self.configuration.evaluation)
        self.remove_pictures()
        words = ["eval", str(self.scene), "-o", str(self.pictures), "-q", "--json", str(report), *self.truth_words()]
        run = self.program.run([*words, *options], self.log)
        if run.code == UNSUPPORTED and "--baselines" in options:
            baselines = ["--baselines", *PANORAMA_BASELINES] if "gathered" in self.program.eval_help else []
            options = [*without(options, "--baselines"), *baselines]
            run = self.program.run([*words, *options], self.log)
        check_run(run, "ibr eval", self.log)
        return read_json(report), run.seconds, options

    def remove_pictures(self):
        self.pictures_run.unlink(missing_ok=True)
        shutil.rmtree(self.pictures, ignore_errors=True)

    def render(self):
        self.remove_pictures()
        run = self.program.run(["render", str(self.scene), "-o", str(self.pictures), "-q", *RENDER_OPTIONS], self.log)
        check_run(run, "ibr render", self.log)
        return run.seconds

    def cached_result(self):
        """Returns the result of an earlier run with the same configuration, program and scene, or None."""
        result, stamp = read_json(self.result), read_json(self.stamp)
        builder = stamp["key"]["program"] if self.reuse_scenes and stamp else self.program.hash
        return result if result and result["build"]["program"] == builder else None

    def run(self):
        say(f"{self.photo_set.name}: build, {len(self.left_out())} photographs left out")
        stamp = self.build()
        cost = quotient(stamp["cpuSeconds"], stamp.get("megapixels"))
        say(f"{self.photo_set.name}: built, {text_of(stamp['seconds'], 0)} s, "
            f"{text_of(cost, 1)} CPU seconds per megapixel; evaluating {self.photo_set.judged}")
        result = {"set": self.photo_set.name, "leftOut": self.left_out(),
                  "build": {"program": stamp["key"]["program"], "seconds": stamp["seconds"],
                            "cpuSeconds": stamp["cpuSeconds"], "megapixels": stamp.get("megapixels"),
                            "cpuSecondsPerMegapixel": cost}}
        if self.photo_set.judged == "pictures":
            result.update(views=[], evalSeconds=self.render(), evalOptions=[])
        else:
            report, seconds, options = self.evaluate()
            result.update(views=report["views"], device=report.get("device"), evalSeconds=seconds, evalOptions=options)
        write_text(self.pictures_run, self.run_name)
        write_json(self.result, result)
        now = summary(result).get("now")
        if now:
            say(f"{self.photo_set.name}: PSNR / SSIM {pair(now['mean'])}, {result['evalSeconds']:.0f} s")
        return result
