#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests check_includes.py: each test plants a violation into a copy of the source tree, which the script must
report."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = "libibr/ARCHITECTURE.md"
MATCH = "libibr/src/author/match/match.cpp"


class ForbiddenIncludes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name in ("libibr/src", "libibr/include", "libibr/python", "apps", "shaders"):
            shutil.copytree(ROOT / name, self.root / name)
        shutil.copy(ROOT / PAGE, self.root / PAGE)

    def check(self):
        run = subprocess.run([sys.executable, ROOT / "tests/check_includes.py", self.root], capture_output=True, text=True)
        return run.returncode, run.stderr

    def edit(self, name, old, new):
        path = self.root / name
        text = path.read_text(encoding="utf-8")
        self.assertIn(old, text)
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    def plant(self, name, include):
        """Appends an include to the file and returns its line number."""
        path = self.root / name
        text = path.read_text(encoding="utf-8") + f"#include {include}\n"
        path.write_text(text, encoding="utf-8")
        return text.count("\n")

    def test_source_tree_passes(self):
        self.assertEqual(self.check(), (0, ""))

    def test_include_that_the_row_does_not_name(self):
        line = self.plant(MATCH, '"author/build/cell_maker.h"')
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertEqual(faults, f"{MATCH}:{line}: author/match may not include author/build "
                                 f"(author/build/cell_maker.h): its row in {PAGE} does not name it\n")

    def test_libraries_outside_their_rooms(self):
        for include, library in (("<CGAL/Delaunay_triangulation_2.h>", "<CGAL>"), ("<vulkan/vulkan.h>", "<vulkan>"),
                                 ("<ceres/ceres.h>", "<ceres>"), ("<nlohmann/json.hpp>", "<nlohmann>")):
            line = self.plant(MATCH, include)
            code, faults = self.check()
            self.assertEqual(code, 1)
            self.assertIn(f"{MATCH}:{line}: author/match may not include {library}", faults)

    def test_program_row_names_internal_room(self):
        row = next(l for l in (self.root / PAGE).read_text(encoding="utf-8").splitlines() if "`apps/viewer/open` |" in l)
        self.edit(PAGE, row, row.replace("`ibr`, ", "`ibr`, `render/plan`, ", 1))
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn(f"{PAGE}: the row of apps/viewer/open names render/plan; programs use the public headers", faults)

    def test_program_includes_internal_room(self):
        line = self.plant("apps/viewer/control/viewer.cpp", '"author/poses/colmap_program.h"')
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn(f"apps/viewer/control/viewer.cpp:{line}: apps/viewer/control may not include author/poses", faults)

    def test_python_row_names_internal_room(self):
        row = next(l for l in (self.root / PAGE).read_text(encoding="utf-8").splitlines() if "`python/runtime` |" in l)
        self.edit(PAGE, row, row.replace("`ibr`, ", "`ibr`, `io`, ", 1))
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn(f"{PAGE}: the row of python/runtime names io; the Python packages use the public headers", faults)

    def test_python_includes_internal_room(self):
        line = self.plant("libibr/python/runtime/module.cpp", '"base/check.h"')
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn(f"libibr/python/runtime/module.cpp:{line}: python/runtime may not include base", faults)

    def test_link_that_the_row_does_not_name(self):
        name = "libibr/src/author/match/CMakeLists.txt"
        self.edit(name, "PUBLIC ", "PUBLIC ibr_author_build ")
        self.assertEqual(self.check(), (1, f"{name}: author/match may not link ibr_author_build: its row in {PAGE} does "
                                           "not name author/build\n"))

    def test_missing_header(self):
        line = self.plant(MATCH, '"author/match/nothing.h"')
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn(f'{MATCH}:{line}: "author/match/nothing.h" is in none of', faults)

    def test_room_without_a_row(self):
        (self.root / "libibr/src/attic").mkdir()
        (self.root / "libibr/src/attic/old.cpp").write_text("", encoding="utf-8")
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn("libibr/src/attic: the room attic has no row", faults)

    def test_row_without_a_room(self):
        shutil.rmtree(self.root / "libibr/src/reload")
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn("the row of reload has no folder of sources", faults)

    def test_cycle_of_rows(self):
        text = (self.root / PAGE).read_text(encoding="utf-8")
        row = next(line for line in text.splitlines() if line.startswith("| `author/geometry` |"))
        cells = row.split("|")
        cells[3] = cells[3].rstrip() + ", `author/match` "
        self.edit(PAGE, row, "|".join(cells))
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn("the rows form a cycle: ", faults)

    def test_cgal_in_two_rooms(self):
        self.edit(PAGE, "`<CGAL>`", "`<CGAL>`, `<vulkan>`")  # still one room with CGAL
        self.assertEqual(self.check()[0], 0)
        text = (self.root / PAGE).read_text(encoding="utf-8")
        row = next(line for line in text.splitlines() if line.startswith("| `author/mesh` |"))
        self.edit(PAGE, row, row.replace("`ibr`", "`ibr`, `<CGAL>`", 1))
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn("<CGAL> is allowed in author/cgal, author/mesh; only one room may have it", faults)

    def test_folder_with_too_many_sources(self):
        for i in range(46):
            (self.root / f"libibr/src/base/more{i}.h").write_text("", encoding="utf-8")
        code, faults = self.check()
        self.assertEqual(code, 1)
        self.assertIn("libibr/src/base: ", faults)
        self.assertIn("at most 45 are allowed", faults)


if __name__ == "__main__":
    unittest.main()
