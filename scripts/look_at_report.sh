#!/bin/sh
# Opens a report in a headless Chromium, as a person would, and takes a picture of the whole page.
#
#   scripts/look_at_report.sh REPORT.html OUT.png [WIDTH]
#
# WIDTH is that of the window in pixels, 1280 unless given (390 is a telephone). Fails when the page breaks its content
# security policy, logs an error, asks for any other file, is wider than the window, holds two labels that overlap in a
# figure or one that is cut off, or when the picture is blank. Installs Debian's chromium when it is missing.
set -eu

if [ "$#" -lt 2 ] || [ "$#" -gt 3 ]; then
    echo "usage: $0 REPORT.html OUT.png [WIDTH]" >&2
    exit 2
fi
[ -f "$1" ] || { echo "$1: no such file" >&2; exit 2; }

missing=
command -v chromium >/dev/null 2>&1 || missing="$missing chromium fonts-liberation"
command -v python3 >/dev/null 2>&1 || missing="$missing python3"
if [ -n "$missing" ]; then
    [ "$(id -u)" = 0 ] || { echo "needs:$missing (as root this script installs them)" >&2; exit 2; }
    apt-get update -qq >&2
    # shellcheck disable=SC2086 # several packages
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2
fi

exec python3 "$(dirname "$0")/look_at_report.py" "$1" "$2" "${3:-1280}"
