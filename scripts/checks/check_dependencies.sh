#!/usr/bin/env bash
# Licences, sources and known faults of the crates that the program is made of, by cargo-deny and deny.toml:
#
#     scripts/checks/check_dependencies.sh                              # all; known faults come from the web
#     scripts/checks/check_dependencies.sh licenses bans sources        # without the web
#
# Compiles cargo-deny into target/deny where there is none, which takes minutes: so it is not part of .ci/run.
set -euo pipefail
cd "$(dirname "$0")/../.."
if ! command -v cargo-deny >/dev/null 2>&1; then
    [ -x target/deny/bin/cargo-deny ] || cargo install --quiet --locked --root target/deny cargo-deny
    PATH=$PWD/target/deny/bin:$PATH
fi
cargo-deny --locked check "$@"
