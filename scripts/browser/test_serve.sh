#!/bin/sh
# Uses the page of `voidwalk serve` in a headless Chromium, as a person would: pastes and drops sheets, gives wrong input, judges, stops,
# loads the page again, continues, compares; and takes a picture of every state into target/serve/.
#
#   [PATIENCE=5] scripts/browser/test_serve.sh [BINARY]      target/release/voidwalk unless given; every wait PATIENCE times as long
#
# Fails where a state is not reached, where the page logs an error, breaks its content security policy or is wider than its window.
set -eu
cd "$(dirname "$0")/../.."
. scripts/browser/chromium.sh
have_commands chromium python3
exec python3 scripts/browser/test_serve.py "${1:-target/release/voidwalk}" target/serve
