#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds a project of tests/consumers against libibr and checks the picture that its program draws.

run.py CONSUMER --build DIR --scene SCENE --expected PROGRAM

DIR: the repository's build folder. Its libraries are installed into a temporary prefix, which is then moved. SCENE: the
scene to draw. PROGRAM: draws the expected picture (the example 01_offscreen). The consumer `fetch_content` builds the
repository's sources in CMake's release configuration instead, whose optimisation the other tests do not have, and draws
a draft too; `author` builds a scene of its own, `examples` is the folder of examples, `configurations` configures the
repository with other options.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# The runtime must not need these. OpenCV and CGAL are the author's, JSON has header files alone.
AUTHOR_LIBRARIES = re.compile(r"opencv|cgal|gmp|mpfr|ceres|jpeg|png|tiff|lcms|openexr|pugixml", re.I)


def run(*command, env=None, cwd=None):
    print("+", *command, flush=True)
    outcome = subprocess.run([str(word) for word in command], text=True, cwd=cwd, env={**os.environ, **(env or {})},
                             stdout=subprocess.PIPE)
    if outcome.returncode != 0:
        fail(f"{command[0]} ended with {outcome.returncode}:\n{outcome.stdout}")
    return outcome.stdout


def fail(text):
    sys.exit(f"run.py: {text}")


def install(build, folder):
    """Installs the build and returns the prefix, moved after the installation."""
    run("cmake", "--install", build, "--prefix", folder / "installed")
    prefix = folder / "moved" / "prefix"
    prefix.parent.mkdir()
    (folder / "installed").rename(prefix)
    for path in sorted(prefix.rglob("*")):
        if path.suffix in (".cmake", ".pc", ".h"):
            for name in (str(folder / "installed"), str(build), str(ROOT)):
                if name in path.read_text(encoding="utf-8"):
                    fail(f"{path.relative_to(prefix)} names {name}")
    return prefix


def configure_and_build(consumer, build, *options):
    run("cmake", "-S", HERE / consumer, "-B", build, "-G", "Ninja", *options)
    run("cmake", "--build", build)
    return build / "consumer"


def needed(program):
    return re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", program))


def check_runtime_library(prefix):
    library = next(prefix.rglob("libibr.so.0"), None) or fail("libibr.so.0 is not installed")
    for name in needed(library):
        if AUTHOR_LIBRARIES.search(name):
            fail(f"libibr.so.0 needs {name}")
    if "[libibr.so.0]" not in run("readelf", "-d", library):
        fail("libibr.so.0 has no SONAME libibr.so.0")
    for header in prefix.glob("include/ibr/*.h"):
        for include in re.findall(r"#include <([^>]+)>", header.read_text(encoding="utf-8")):
            if re.match(r"opencv2|CGAL|nlohmann|ceres|fmt|pugixml", include):
                fail(f"{header.name} includes {include}")
    return library


def build_shared(folder, prefix):
    program = configure_and_build("shared", folder / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    check_runtime_library(prefix)
    if "libibr.so.0" not in needed(program):
        fail("the program does not link libibr.so.0")
    return program, {}


def compile_with_pkg_config(package, prefix, source, program):
    folder = next(prefix.rglob("pkgconfig"))
    flags = run("pkg-config", "--cflags", "--libs", package, env={"PKG_CONFIG_PATH": str(folder)})
    run("g++", "-std=c++20", source, "-o", program, *flags.split())


def build_pkg_config(folder, prefix):
    library = check_runtime_library(prefix)
    compile_with_pkg_config("ibr", prefix, ROOT / "examples/01_offscreen.cpp", folder / "consumer")
    return folder / "consumer", {"LD_LIBRARY_PATH": str(library.parent)}


def build_draft(build, folder):
    """Builds a scene without cells."""
    photographs = ROOT / "examples/photographs/cathedral"
    run(build / "apps/batch/ibr", "build", photographs, "-o", folder / "draft", "--draft", "--max-size", "480", "-q")
    return folder / "draft"


def build_fetch_content(folder, _):
    return configure_and_build("fetch_content", folder / "build", "-DCMAKE_BUILD_TYPE=Release"), {}


def check_mixed_linkage(folder, prefix):
    """A program that links a shared and a static libibr is refused."""
    (folder / "mixed").mkdir()
    (folder / "mixed/CMakeLists.txt").write_text("""cmake_minimum_required(VERSION 3.25)
project(mixed LANGUAGES CXX)
find_package(ibr REQUIRED COMPONENTS runtime)
find_package(ibr REQUIRED COMPONENTS author)
add_executable(mixed mixed.cpp)
target_link_libraries(mixed PRIVATE ibr::runtime ibr::author)
""", encoding="utf-8")
    (folder / "mixed/mixed.cpp").write_text("int main() {}\n", encoding="utf-8")
    outcome = subprocess.run(["cmake", "-S", folder / "mixed", "-B", folder / "mixed/build", "-G", "Ninja",
                              f"-DCMAKE_PREFIX_PATH={prefix}"], text=True, capture_output=True)
    if outcome.returncode == 0 or "an earlier find_package(ibr)" not in " ".join(outcome.stderr.split()):
        fail(f"a program with a shared and a static libibr is not refused:\n{outcome.stderr}")


def check_author(folder, prefix):
    """Builds a scene and draws it."""
    check_mixed_linkage(folder, prefix)
    compile_with_pkg_config("ibr-author", prefix, HERE / "author/main.cpp", folder / "pkg_config")
    if any(name.startswith("libibr") for name in needed(folder / "pkg_config")):
        fail("ibr-author.pc links a shared libibr")
    program = configure_and_build("author", folder / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    if any(name.startswith("libibr") for name in needed(program)):
        fail("the program links a shared libibr beside the static author")
    photographs = ROOT / "examples" / "photographs" / "cathedral"
    picture = folder / "picture.ppm"
    run(program, photographs, photographs / "sparse", folder / "scene", picture)
    pixels = picture.read_bytes()[len(b"P6\n320 240\n255\n"):]
    # The view of a photograph is filled by it: no hole, and the brightness of a sunlit building.
    if len(pixels) != 320 * 240 * 3:
        fail(f"the picture has {len(pixels)} bytes of pixels")
    mean = sum(pixels) / len(pixels)
    black = sum(1 for i in range(0, len(pixels), 3) if pixels[i:i + 3] == b"\0\0\0") / (320 * 240)
    if not 60 < mean < 200 or black > 0.02:
        fail(f"mean level {mean:.1f}, share of black pixels {black:.3f}")


def build_examples(folder, prefix, linkage, *tests):
    build = folder / f"examples_{linkage}"
    run("cmake", "-S", ROOT / "examples", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
        f"-DIBR_PROGRAM={prefix / 'bin/ibr'}")
    run("cmake", "--build", build)
    print(run("ctest", "--test-dir", build, "--output-on-failure", "--no-tests=error", *tests))
    links_shared = "libibr.so.0" in needed(build / "01_offscreen")
    if links_shared != (linkage == "shared"):
        fail(f"01_offscreen does not link the {linkage} library")


def check_examples(folder, prefix):
    """The examples are built alone, with the shared library where the author is not installed. The installed program
    ibr makes their scenes, and CTest checks their pictures."""
    author = next(prefix.rglob("ibr-author.cmake"))
    hidden = author.rename(author.with_suffix(".hidden"))
    build_examples(folder, prefix, "shared")
    hidden.rename(author)
    build_examples(folder, prefix, "static", "-R", "06_optimise_mesh")


def check_configurations(folder, _):
    """The repository can be configured with other options."""
    run("cmake", "-S", ROOT, "-B", folder / "shared", "-G", "Ninja", "-DBUILD_SHARED_LIBS=ON")
    run("cmake", "-S", ROOT, "-B", folder / "no_examples", "-G", "Ninja", "-DIBR_BUILD_EXAMPLES=OFF")
    run("cmake", "-S", ROOT, "-B", folder / "no_author", "-G", "Ninja", "-DIBR_BUILD_AUTHOR=OFF")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("consumer", choices=("shared", "pkg_config", "author", "examples", "configurations", "fetch_content"))
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--scene", type=pathlib.Path, required=True)
    parser.add_argument("--expected", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="ibr-consumer-") as name:
        folder = pathlib.Path(name)
        uses_sources = arguments.consumer in ("fetch_content", "configurations")
        prefix = None if uses_sources else install(arguments.build.resolve(), folder)
        if arguments.consumer in ("author", "examples", "configurations"):
            globals()[f"check_{arguments.consumer}"](folder, prefix)
            return
        program, environment = globals()[f"build_{arguments.consumer}"](folder, prefix)
        scenes = [arguments.scene]
        if arguments.consumer == "fetch_content":
            scenes.append(build_draft(arguments.build, folder))
        for scene in scenes:
            run(program, scene, folder / "picture.ppm", env=environment)
            run(arguments.expected, scene, folder / "expected.ppm")
            if (folder / "picture.ppm").read_bytes() != (folder / "expected.ppm").read_bytes():
                shutil.copy(folder / "picture.ppm", f"consumer_{arguments.consumer}.ppm")
                fail(f"the picture of {scene.name} differs from that of {arguments.expected.name}: "
                     f"consumer_{arguments.consumer}.ppm")


if __name__ == "__main__":
    main()
