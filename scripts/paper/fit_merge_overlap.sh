#!/usr/bin/env bash
# Cu of the six filters' constriction curves against the overlap from which tetrahedra are one void, beside the paper's Table 2:
#     scripts/paper/fit_merge_overlap.sh [FOLDER]
# FOLDER (default target/filters) is where scripts/paper/make_filters.sh has put the packings. Prints a Markdown table.
set -euo pipefail
cd "$(dirname "$0")/../.."
out="${1:-target/filters}"
names=(cu1.2-dense cu1.5-dense cu1.5-loose cu3-dense cu3-loose cu6-friction0.7)
paper=(1.48 1.52 1.63 1.57 1.60 1.57)
echo "| merge_overlap | ${names[*]} | root mean square difference |" | sed 's/ cu/ | cu/g; s/| | /| /'
echo "|---|---|---|---|---|---|---|---|"
echo "| paper | ${paper[*]} | |" | sed 's/\([0-9]\) \([0-9]\)/\1 | \2/g'
for overlap in 0 0.05 0.1 0.15 0.2 0.3 0.5 0.7 1; do
    row="| $overlap |"
    squares=0
    for i in "${!names[@]}"; do
        cu=$(target/release/voidwalk constrictions "$out/${names[$i]}/grains.csv" --merge-overlap "$overlap" \
            --out "$out/overlap" --overwrite --json | sed -n 's/.*"cu_csd": *\([0-9.]*\),*/\1/p')
        row+=$(printf ' %.3f |' "$cu")
        squares=$(awk -v s="$squares" -v a="$cu" -v b="${paper[$i]}" 'BEGIN { print s + (a - b) ^ 2 }')
    done
    awk -v row="$row" -v s="$squares" 'BEGIN { printf "%s %.4f |\n", row, sqrt(s / 6) }'
done
