#!/usr/bin/env bash
# The structure of the code and the rules for its prose, checked without compiling anything.
set -uo pipefail
cd "$(dirname "$0")"
failed=0
python3 -B circles.py || failed=1
python3 -B sizes.py || failed=1
exit $failed
