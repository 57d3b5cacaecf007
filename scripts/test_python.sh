#!/usr/bin/env bash
# The Python package as a user gets it: installed by pip into an environment of its own, then its tests, the examples in its
# docstrings, and its types. OpenPNM, pandas and xarray come in too; with ALL=1 also PoreSpy, which takes a minute more.
# With --environment it only fetches what the tests need.
set -euo pipefail
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
environment=target/python
[ -x $environment/bin/python ] || "$python" -m venv $environment
packages=(numpy pytest pytest-timeout mypy pandas xarray scipy tqdm openpnm matplotlib)
[ -z "${ALL:-}" ] || packages+=(porespy)
$environment/bin/pip install --quiet --disable-pip-version-check "${packages[@]}"
[ "${1:-}" != --environment ] || exit 0
cargo build --release
# With the very features of the command line the library is the one that was compiled for it: minutes less.
MATURIN_PEP517_ARGS="--features voidwalk/default" \
    $environment/bin/pip install --quiet --disable-pip-version-check --force-reinstall --no-deps .

# From elsewhere, so that what is tested is what was installed.
here=$PWD
export VOIDWALK_PROGRAM=$here/target/release/voidwalk
cd target
python/bin/python -m pytest -c "$here/pyproject.toml" --rootdir "$here" -p no:cacheprovider --timeout 120 \
    "$here/scripts/python/tests" "$@"
python/bin/python -m pytest -c "$here/pyproject.toml" -p no:cacheprovider --pyargs voidwalk
