#!/bin/sh
# Draws every figure of a results folder as a PNG beside its SVG, for programs that take no SVG.
#
#   scripts/browser/figures_to_png.sh FOLDER [WIDTH]
#
# WIDTH is that of the pictures in pixels, 1440 unless given. Needs a Chromium and Python (as root on Debian it installs
# them); `inkscape --export-type=png figures/*.svg` and `rsvg-convert` do the same where they are.
set -eu

if [ "$#" -lt 1 ] || [ "$#" -gt 2 ]; then
    echo "usage: $0 FOLDER [WIDTH]" >&2
    exit 2
fi
width=${2:-1440}
case $width in
    *[!0-9]* | '' | 0* | ??????*) echo "$width: allowed: a width in pixels from 1 to 99999" >&2; exit 2 ;;
esac
[ -d "$1/figures" ] || { echo "$1: holds no figures; name the folder of a finished run, packing or campaign" >&2; exit 2; }
. "$(dirname "$0")/chromium.sh"
have_commands chromium python3
exec python3 "$(dirname "$0")/figures_to_png.py" "$1" "$width"
