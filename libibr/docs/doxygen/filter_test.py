#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests filter.py: each test names a property of the filtered text, or of the public headers."""
import pathlib
import unittest

from filter import COMPARED, DELETED, MOVED, Filter

HEADERS = pathlib.Path(__file__).resolve().parents[2] / "include/ibr"


def filtered(text):
    return Filter(text).run()


class Comments(unittest.TestCase):
    def test_comment_below_the_licence_describes_the_file(self):
        self.assertEqual(filtered("// SPDX-License-Identifier: X\n// Cameras.\n//\n// More.\n#pragma once\n"),
                         "/// @file\n/// Cameras.\n///\n/// More.\n#pragma once\n")

    def test_comment_behind_a_member_describes_it_with_its_continuation(self):
        self.assertEqual(filtered("struct A {\n  int b = 0;  // width,\n              // px\n  int c;\n};\n"),
                         "struct A {\n  /** width, px */ int b = 0;\n\n  int c;\n};\n")

    def test_comment_above_a_member_is_no_continuation(self):
        self.assertEqual(filtered("struct A {\n  int b;  // first\n  // second\n  int c;\n};\n"),
                         "struct A {\n  /** first */ int b;\n\n  /** second */ int c;\n};\n")

    def test_heading_of_members_with_comments_describes_none(self):
        self.assertEqual(filtered("struct A {\n  // Alg. 1\n  int b;  // first\n};\n"),
                         "struct A {\n  // Alg. 1\n  /** first */ int b;\n};\n")

    def test_comment_behind_the_head_of_a_type_describes_the_type(self):
        self.assertEqual(filtered("struct A {  // a point\n  // px\n  int x;\n};\n"),
                         "/** a point */ struct A {\n\n  /** px */ int x;\n};\n")

    def test_enumerators_keep_their_comments(self):
        self.assertEqual(filtered("enum class A {\n  b,  // first\n  c   // last\n};\n"),
                         "enum class A {\n  /** first */ b,\n  /** last */ c\n};\n")

    def test_comment_behind_an_enumeration_in_one_line_describes_no_enumerator(self):
        self.assertEqual(filtered("enum class A { b, c };  // both\n"), "enum class A { b, c };  // both\n")

    def test_variable_behind_its_type_gets_the_comment(self):
        self.assertEqual(filtered("struct A {\n  struct B {\n    int c;\n  } d;  // bytes\n};\n"),
                         "struct A {\n  struct B {\n    int c;\n  } d; ///< bytes\n};\n")

    def test_comment_behind_a_function_with_a_body_describes_it(self):
        self.assertEqual(filtered("struct A {\n  int b() const { return 1; }  // px\n};\n"),
                         "struct A {\n  /** px */ int b() const { return 1; }\n};\n")

    def test_strings_with_slashes_are_no_comments(self):
        self.assertEqual(filtered('const char* a = "http://b";  // address\n'),
                         '/** address */ const char* a = "http://b";\n')

    def test_characters_of_markup_are_escaped(self):
        self.assertEqual(filtered("int a;  // > 0, e.g. <b> of *this, `<c>`\n"),
                         "/** \\> 0, e.g.\\ \\<b\\> of \\*this, `<c>` */ int a;\n")

    def test_text_that_would_end_a_comment_is_refused(self):
        with self.assertRaises(ValueError):
            filtered("int a;  // in cells/*/\n")


class SeveralVariables(unittest.TestCase):
    def test_one_comment_describes_all(self):
        self.assertEqual(filtered("struct A {\n  std::array<int, 2> b{}, c{1, 2};  // px\n};\n"),
                         "struct A {\n  /** px */ std::array<int, 2> b{}; /** px */ std::array<int, 2> c{1, 2};\n};\n")

    def test_labels_assign_parts(self):
        self.assertEqual(filtered("int a, b, c;  // In px. a: width; b, c: height\n"),
                         "/** In px: width */ int a; /** In px: height */ int b; /** In px: height */ int c;\n")

    def test_variable_without_label_gets_no_text_of_another(self):
        self.assertEqual(filtered("int a, b;  // b: last\n"), "int a; /** last */ int b;\n")

    def test_labels_may_stand_above(self):
        self.assertEqual(filtered("struct A {\n  // b: first; c: last\n  int b, c;\n};\n"),
                         "struct A {\n\n  /** first */ int b; /** last */ int c;\n};\n")

    def test_documentation_above_is_repeated_from_the_second_on(self):
        self.assertEqual(filtered("struct A {\n  /// Size,\n  /// px.\n  int b, c;\n};\n"),
                         "struct A {\n  /// Size,\n  /// px.\n  int b; /** Size,@linebreak px. */ int c;\n};\n")


class Groups(unittest.TestCase):
    def test_overload_below_shares_documentation(self):
        self.assertEqual(filtered("/// Error, dB.\ndouble psnr(int a);\ndouble psnr(int a, int b);\n"),
                         "/// Error, dB.\ndouble psnr(int a);\n/** Error, dB. */ double psnr(int a, int b);\n")

    def test_function_that_the_documentation_names_shares_it(self):
        self.assertIn("/** lock() waits; unlock() does not. */ void unlock();",
                      filtered("/// lock() waits; unlock() does not.\nvoid lock();\nvoid unlock();\n"))

    def test_other_function_below_stays_without_documentation(self):
        self.assertIn("\nint b();", filtered("/// The first.\nint a();\nint b();\n"))

    def test_blank_line_ends_a_group(self):
        self.assertIn("\n\nint a(int b);", filtered("/// The first.\nint a();\n\nint a(int b);\n"))

    def test_member_below_shares_no_documentation(self):
        self.assertIn("\n  int c;", filtered("struct A {\n  /// The first.\n  int b;\n  int c;\n};\n"))

    def test_macros_below_share_documentation(self):
        self.assertEqual(filtered("/// Version.\n#define A 0\n#define B 1\n"),
                         "/// Version.\n#define A 0\n#define B 1 /**< Version. */\n")


class StandardTexts(unittest.TestCase):
    def test_moves_copies_and_comparisons_get_a_text(self):
        text = filtered("class A {\n public:\n  A(A&&) noexcept;\n  A& operator=(A&&) noexcept;\n"
                        "  A(const A&) = delete;\n  bool operator==(const A&) const = default;\n  ~A();\n};\n")
        self.assertIn(f"  /** {MOVED} */ A(A&&) noexcept;\n  /** {MOVED} */ A& operator=(A&&) noexcept;\n", text)
        self.assertIn(f"  /** {DELETED} */ A(const A&) = delete;\n", text)
        self.assertIn(f"  /** {COMPARED} */ bool operator==(const A&) const = default;\n  ~A();\n", text)


class Layout(unittest.TestCase):
    def test_indented_code_becomes_a_block_of_code(self):
        self.assertEqual(filtered("/// Draws.\n///\n///   draw(1);  // once\n///   draw(2);\nvoid draw(int a);\n"),
                         "/** Draws.\n@code{.cpp}\ndraw(1);  // once\ndraw(2); @endcode */\nvoid draw(int a);\n")

    def test_table_keeps_its_columns(self):
        self.assertEqual(filtered("/// Sizes:\n///   a   1\n///   bc  2\nint a();\n"),
                         "/** Sizes: @verbatim\na   1\nbc  2 @endverbatim */\nint a();\n")


class PublicHeaders(unittest.TestCase):
    def headers(self):
        for path in sorted(HEADERS.rglob("*.h")):
            if HEADERS / "lab" not in path.parents:
                yield path.relative_to(HEADERS).as_posix(), path.read_text(encoding="utf-8")

    def test_declarations_stay_on_their_lines(self):
        for name, text in self.headers():
            with self.subTest(name):
                lines = filtered(text).split("\n")
                self.assertEqual(len(lines), len(text.split("\n")))
                for number, line in enumerate(text.split("\n")):
                    if line.endswith("{") and "//" not in line:
                        self.assertIn(line.strip(), lines[number])

    def test_every_enumerator_has_a_comment(self):  # Doxygen does not warn about enumerators
        for name, text in self.headers():
            header = Filter(text)
            header.run()
            for item in header.items:
                if item.kind == "enumerator":
                    self.assertTrue(item.texts, f"{name}:{item.first + 1}: {item.code}")


if __name__ == "__main__":
    unittest.main()
