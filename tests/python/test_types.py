# SPDX-License-Identifier: Apache-2.0
"""The type stubs name what the modules have, with the same parameters; mypy accepts package and example."""

import ast
import enum
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import support

import ibr
import ibr._runtime
import ibr.author
import ibr.author._author

PACKAGE = pathlib.Path(ibr.__file__).parent
STUBS = {
    ibr._runtime: ["_runtime.pyi", *(f"_stubs/{name}.pyi" for name in ("drawing", "enums", "models", "scene"))],
    ibr.author._author: ["author/_author.pyi", "author/_stubs.pyi"],
}


def definitions_of(files):
    """Returns public classes, functions and variables of stub files, by name."""
    found = {}
    for file in files:
        for node in ast.parse((PACKAGE / file).read_text(encoding="utf-8")).body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                found[node.name] = node
            elif isinstance(node, ast.AnnAssign):
                found[node.target.id] = node
    return found


def parameters_of_stub(function):
    """Returns (name, is keyword-only, has a default) of each parameter."""
    arguments = function.args
    required = len(arguments.args) - len(arguments.defaults)
    found = [(argument.arg, False, i >= required) for i, argument in enumerate(arguments.args)]
    defaults = arguments.kw_defaults
    return found + [(argument.arg, True, default is not None) for argument, default in zip(arguments.kwonlyargs, defaults)]


def parameters_of_doc(doc, name):
    """Returns the same from the first line of a docstring of pybind11: `name(a: int, *, b: str = '') -> int`."""
    if "Overloaded function." in doc:
        doc = doc[doc.index("1. ") :]
    start = doc.index(name + "(") + len(name) + 1
    depth, parts, part = 0, [], ""
    for character in doc[start:]:
        if depth == 0 and character in ",)":
            parts.append(part.strip())
            part = ""
            if character == ")":
                break
            continue
        depth += character in "([{"
        depth -= character in ")]}"
        part += character
    found, keyword_only = [], False
    for part in filter(None, parts):
        if part == "*":
            keyword_only = True
        else:
            found.append((re.match(r"\w+", part)[0], keyword_only, " = " in part))
    return found


def members_of_stub(node):
    """Returns the attributes and the functions of a class."""
    attributes, functions = [], {}
    for member in node.body:
        if isinstance(member, ast.AnnAssign):
            attributes.append(member.target.id)
        elif isinstance(member, ast.FunctionDef):
            if any(isinstance(d, ast.Name) and d.id == "property" for d in member.decorator_list):
                attributes.append(member.name)
            else:
                functions[member.name] = member
    return attributes, functions


class Stubs(unittest.TestCase):
    def test_stubs_name_what_modules_have(self):
        for module, files in STUBS.items():
            names = {name for name in vars(module) if not name.startswith("_")}
            self.assertEqual(names, {name for name in definitions_of(files) if not name.startswith("_")})

    def test_packages_export_what_modules_have(self):
        self.assertEqual(set(ibr.__all__) - {"__version__"}, {n for n in vars(ibr._runtime) if not n.startswith("_")})
        python = {"Evaluation", "ViewEvaluation", "evaluate", "held_out", "read_htm_picture"}
        self.assertEqual(
            set(ibr.author.__all__) - python, {n for n in vars(ibr.author._author) if not n.startswith("_")}
        )
        for package in (ibr, ibr.author):
            self.assertEqual(sorted(set(package.__all__)), sorted(package.__all__))
            for name in package.__all__:
                self.assertTrue(hasattr(package, name), name)

    def test_enumerations_have_the_members_of_their_stubs(self):
        for module, files in STUBS.items():
            for name, node in definitions_of(files).items():
                made = getattr(module, name)
                if not (isinstance(made, type) and issubclass(made, enum.Enum)):
                    continue
                members = {member.targets[0].id: member.value.value for member in node.body}
                self.assertEqual({member.name: member.value for member in made}, members, name)

    def test_classes_have_the_attributes_and_functions_of_their_stubs(self):
        for module, files in STUBS.items():
            for name, node in definitions_of(files).items():
                made = getattr(module, name)
                if not isinstance(made, type) or issubclass(made, (enum.Enum, ibr.Error)):
                    continue
                attributes, functions = members_of_stub(node)
                found = {n for n in vars(made) if not n.startswith("_")} - set(functions)
                self.assertEqual(found, {a for a in attributes if not a.startswith("_")}, name)
                if "__match_args__" in vars(made):
                    self.assertEqual(attributes[1 : 1 + len(made.__match_args__)], list(made.__match_args__), name)
                for function, stub in functions.items():
                    self.check_parameters(made, f"{name}.{function}", function, stub)

    def test_functions_have_the_parameters_of_their_stubs(self):
        for module, files in STUBS.items():
            for name, node in definitions_of(files).items():
                if isinstance(node, ast.FunctionDef):
                    self.check_parameters(module, name, name, node)

    def check_parameters(self, scope, where, name, stub):
        parameters = parameters_of_stub(stub)
        is_record = "__match_args__" in vars(scope)
        if is_record and name in ("__init__", "replace"):  # they take any field
            self.assertEqual([parameter for parameter, _, _ in parameters[1:]], list(scope.__match_args__), where)
            self.assertEqual({keyword for _, keyword, _ in parameters[1:]}, {name == "replace"}, where)
            self.assertTrue(all(default for _, _, default in parameters[1:]), where)
            return
        if name.startswith("__") and name != "__init__":
            self.assertTrue(hasattr(scope, name), where)
            return
        made = getattr(scope, name)
        self.assertEqual(parameters_of_doc(made.__doc__, name), parameters, where)

    def test_everything_has_a_docstring(self):
        for module, files in STUBS.items():
            for name, node in definitions_of(files).items():
                made = getattr(module, name)
                if isinstance(made, type):
                    self.assertTrue(made.__doc__, name)
                    for attribute in members_of_stub(node)[0]:
                        if isinstance(vars(made).get(attribute), property):
                            self.assertTrue(getattr(made, attribute).__doc__, f"{name}.{attribute}")
                elif callable(made):
                    self.assertIn("\n\n", made.__doc__, name)  # text after the signature

    def test_mypy_accepts_package_and_example(self):
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("mypy is not installed (Debian: mypy)")
        with tempfile.TemporaryDirectory() as cache:
            example = ["--ignore-missing-imports", support.SOURCE / "examples/plot_scene.py"]  # matplotlib has no types
            for arguments in (["-p", "ibr"], example):
                run = subprocess.run(
                    [sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache, *map(str, arguments)],
                    env={**os.environ, "MYPYPATH": str(PACKAGE.parent)},
                    capture_output=True,
                    text=True,
                )
                self.assertEqual(run.returncode, 0, run.stdout + run.stderr)


if __name__ == "__main__":
    support.main()
