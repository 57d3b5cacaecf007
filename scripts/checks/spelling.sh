#!/usr/bin/env bash
# The spelling of code, comments and documents, by typos (prebuilt, from PyPI, into target/spelling). typos.toml has the words that
# are right although they do not look so; `scripts/checks/spelling.sh --write-changes` mends what has one correction.
set -euo pipefail
cd "$(dirname "$0")/../.."
version=1.52.0
environment=target/spelling
if [ "$("$environment/bin/typos" --version 2>/dev/null)" != "typos-cli $version" ]; then
    rm -rf "$environment"
    "${PYTHON:-python3}" -m venv "$environment"
    "$environment/bin/pip" install --quiet --disable-pip-version-check "typos==$version"
fi
exec "$environment/bin/typos" --config typos.toml "$@"
