#!/usr/bin/env bash
# The quick check: form, spelling, lints, and the order of the house. Everything else: .ci/run.
set -euo pipefail
cd "$(dirname "$0")/../.."
cargo fmt --all --check
scripts/checks/spelling.sh
cargo clippy --workspace --all-targets -- -D warnings
cargo test --quiet --test house
