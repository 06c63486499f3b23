# SPDX-License-Identifier: Apache-2.0
"""What we wrote obeys our schema, and the schema refuses what is wrong."""
import copy
import json
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)


def run(extension_name, breaks):
    """Arguments of the program: SCHEMA DOCUMENT.gltf. Each of `breaks` changes the extension's content so that it breaks
    one rule; a schema that lets it pass says too little."""
    with open(sys.argv[1], encoding="utf-8") as file:
        schema = json.load(file)
    with open(sys.argv[2], encoding="utf-8") as file:
        extension = json.load(file)["extensions"][extension_name]
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    faults = [f"/{'/'.join(map(str, e.absolute_path))}: {e.message}" for e in validator.iter_errors(extension)]
    for fault in faults:
        print("refused:", fault)
    for number, change in enumerate(breaks):
        wrong = copy.deepcopy(extension)
        change(wrong)
        if validator.is_valid(wrong):
            faults.append(number)
            print("let pass: wrong document", number)
    print(f"{len(faults)} faults; {len(breaks)} wrong documents tried")
    sys.exit(1 if faults else 0)
