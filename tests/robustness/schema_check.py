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


def run(part_of, breaks):
    """Arguments of the program: SCHEMA DOCUMENT. `part_of` gives what the schema is of, from the document. Each of
    `breaks` changes it so that it breaks one rule; a schema that lets it pass says too little."""
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
            print("let pass: wrong document", number)
    print(f"{len(faults)} faults; {len(breaks)} wrong documents tried")
    sys.exit(1 if faults else 0)
