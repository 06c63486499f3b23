#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds scenes without some photographs, renders the views of these photographs, and compares images with photographs:
#   tests/quality.sh DATASETS [SET…]      all sets in DATASETS, or the named ones
#   tests/quality.sh --small              bundled photographs, reduced; fails if views are worse than the reference
# tests/quality.sh --help lists the options and the sets. Environment:
#   IBR=PROGRAM        program to evaluate [build/ci/apps/batch/ibr, else build/release/apps/batch/ibr]
#   PYTHON=PROGRAM     Python [/usr/bin/python3, else python3; only Debian's Python finds Debian's python3-pil]
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)

if [ -z "${IBR-}" ]; then
  for IBR in "$root/build/ci/apps/batch/ibr" "$root/build/release/apps/batch/ibr"; do
    [ ! -x "$IBR" ] || break
  done
fi
export IBR

if [ -z "${PYTHON-}" ]; then
  PYTHON=/usr/bin/python3
  [ -x "$PYTHON" ] || PYTHON=python3
fi
# -B: no compiled modules in the source tree.
exec "$PYTHON" -B "$root/tests/quality/main.py" "$@"
