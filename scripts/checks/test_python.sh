#!/usr/bin/env bash
# The Python package as a user gets it: installed by pip into an environment of its own, then its tests, the examples, those in its
# docstrings, and its types. OpenPNM, pandas and xarray come in too; with ALL=1 also PoreSpy, which takes a minute more. The last test is
# of the paper's page (scripts/paper), which needs Python 3.11.
# With --environment it only fetches what the tests need; other arguments are pytest's, and leave out what kills the package.
# PROFILE names a profile of cargo's other than release, such as dev, which compiles faster and walks slower.
set -euo pipefail
cd "$(dirname "$0")/../.."

python=${PYTHON:-python3}
environment=target/python
[ -x $environment/bin/python ] || "$python" -m venv $environment
packages=("maturin>=1.9,<2" numpy pytest pytest-timeout pytest-xdist mypy pandas pandas-stubs xarray scipy tqdm openpnm matplotlib
    jsonschema)
[ -z "${ALL:-}" ] || packages+=(porespy)
# Compiled when they are imported: most of their files are not.
$environment/bin/pip install --no-compile --quiet --disable-pip-version-check "${packages[@]}"
[ "${1:-}" != --environment ] || exit 0

step() { printf '%4d s  %s\n' "$SECONDS" "$1"; }

# The whole workspace and its profile: the library is the one that `cargo test --release --workspace` compiled, and only the
# module is compiled for Python.
profile=${PROFILE:-release}
step "program and module"
cargo build --profile "$profile" --workspace --bins
# Cargo's folder of profile dev has another name. This program also says what the types of the package are.
export VOIDWALK_PROGRAM=$PWD/target/${profile/#dev/debug}/voidwalk
step "pip install"
PATH=$PWD/$environment/bin:$PATH MATURIN_PEP517_ARGS="--profile $profile" $environment/bin/pip install --quiet \
    --disable-pip-version-check --no-build-isolation --force-reinstall --no-deps .

# From elsewhere, so that what is tested is what was installed. A test that walks for long has the other worker beside it.
here=$PWD
cd target
step "tests"
python/bin/python -m pytest -c "$here/pyproject.toml" --rootdir "$here" -p no:cacheprovider --timeout 300 -n 2 --dist worksteal \
    "$here/scripts/python/tests" "$@"
step "examples in docstrings"
python/bin/python -m pytest -c "$here/pyproject.toml" -p no:cacheprovider --pyargs voidwalk
if [ "$#" = 0 ]; then
    step "killed, cut and without room"
    ../scripts/checks/supervise.py --kills 16 --binary "$VOIDWALK_PROGRAM" --python python/bin/python \
        --commands python-run python-campaign
    step "the page of the paper"
    python/bin/python ../scripts/paper/test_paper.py "$VOIDWALK_PROGRAM"
fi
step "done"
