# SPDX-License-Identifier: Apache-2.0
"""Checks that a document obeys its schema, and that the schema refuses wrong documents."""
import copy
import json
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)


def run(part_of, breaks):
    """Arguments of the program: SCHEMA DOCUMENT. `part_of` returns the part of the document that the schema describes.
    Each of `breaks` changes this part so that it violates one rule; the schema must refuse the result."""
    with open(sys.argv[1], encoding="utf-8") as file:
        schema = json.load(file)
    with open(sys.argv[2], encoding="utf-8") as file:
        content = part_of(json.load(file))
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    faults = [f"/{'/'.join(map(str, e.absolute_path))}: {e.message[:200]}" for e in validator.iter_errors(content)]
    for fault in faults:
        print("refused:", fault)
    for number, change in enumerate(breaks):
        wrong = copy.deepcopy(content)
        change(wrong)
        if validator.is_valid(wrong):
            faults.append(number)
            print("accepted: wrong document", number)
    print(f"{len(faults)} faults; {len(breaks)} wrong documents tried")
    sys.exit(1 if faults else 0)
