#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds scenes without some photographs, renders those views, and compares them with the photographs:
#   tests/quality.sh DATASETS [SET…]      all sets of DATASETS, or these
#   tests/quality.sh --small              bundled photographs, reduced; fails where views got worse
# tests/quality.sh --help lists the options and the sets. Environment:
#   IBR=PROGRAM        the program to judge [build/ci/apps/batch/ibr, else build/release/apps/batch/ibr]
#   PYTHON=PROGRAM     [/usr/bin/python3, else python3: Debian's python3-pil is seen only by Debian's Python]
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
