#!/usr/bin/env bash
# Uses a wheel, or a source distribution, as a newcomer would: into an environment of its own, then a first verdict from the
# command line and one from Python. Every step is timed.
#
#     scripts/install/try_package.sh wheels/voidwalk-*.whl
#
# PYTHON names another Python. matplotlib comes in last, for the example, which draws.
set -euo pipefail
package=$(realpath "$1")
cd "$(dirname "$0")/../.."
here=$PWD

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
timed() { # words: runs them and says how long that took
    local begun code=0
    begun=$(date +%s.%N)
    "$@" || code=$?
    printf '== %6.1f s, exit code %d: %s\n' "$(echo "$(date +%s.%N) $begun" | awk '{ print $1 - $2 }')" "$code" "${*/#$here\//}"
    return "$code"
}

"${PYTHON:-python3}" -m venv "$work/environment"
bin=$work/environment/bin
[ -d "$bin" ] || bin=$work/environment/Scripts
export PATH="$bin:$PATH"
cd "$work"
printf 'size_mm,percent\n0.5,100\n0.25,80\n0.125,45\n0.063,12\n' >base.csv
printf 'size_mm,percent\n8,100\n4,85\n2,55\n1,25\n0.5,5\n' >filter.csv

timed python -m pip install --quiet "$package"
timed voidwalk --version
timed python -m voidwalk --version
timed voidwalk judge base.csv filter.csv --density loose --quick --quiet --out first
[ -s first/report.html ]
timed voidwalk judge base.csv filter.csv --density loose --quiet --out whole
# What is refused is refused with the program's exit code, and a reader may leave.
code=0
voidwalk judge base.csv no-such-sheet.csv --density loose 2>refused.txt || code=$?
[ "$code" = 2 ] && grep -q '^refused: ' refused.txt
voidwalk init | head -n 1 >/dev/null
timed python -c 'import voidwalk; print(voidwalk.__version__)'
timed python -m pip install --quiet matplotlib
timed python "$here/scripts/examples/first_verdict.py"
