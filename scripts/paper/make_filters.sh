#!/usr/bin/env bash
# Packs the six filters of the paper's Table 2 by one protocol and writes their curves, ready to be shipped:
#     scripts/paper/make_filters.sh [FOLDER] [NAME ...]
# FOLDER (default target/filters) keeps the packings, so that a second call only measures; NAME picks some of the six.
# Writes FOLDER/shipped/NAME.csv and FOLDER/shipped/filters.toml (an entry each), and prints the table of results/packing.md.
set -euo pipefail
cd "$(dirname "$0")/../.."
out="${1:-target/filters}"
[ $# -gt 0 ] && shift
cargo build --release --quiet
voidwalk=target/release/voidwalk
mkdir -p "$out/shipped"

# name, Cu, friction, grains, what it is; void ratio and Cu_CSD of the paper's Table 2
filters="
cu1.2-dense 1.2 0 8262 dense 0.558 1.48
cu1.5-dense 1.5 0 9313 dense 0.531 1.52
cu1.5-loose 1.5 0.3 9313 loose 0.658 1.63
cu3-dense 3 0 22600 dense 0.382 1.57
cu3-loose 3 0.3 22600 loose 0.455 1.60
cu6-friction0.7 6 0.7 60000 friction-0.7 0.340 1.57
"

number() { # number FILE KEY: the number behind the last "KEY" of a JSON file
    sed -n "s/.*\"$2\": *\([-0-9.e+]*\),\{0,1\}\$/\1/p" "$1" | tail -1
}

echo "| filter | void ratio before, after friction 0.3 | paper | Cu_CSD | paper | Dc0 / D0F | grains per void | mean coordination number without rattlers | steps | s |"
echo "|---|---|---|---|---|---|---|---|---|---|"
while read -r name cu friction grains state paper_e paper_cu; do
    [ -z "$name" ] && continue
    if [ $# -gt 0 ] && ! printf '%s\n' "$@" | grep -qx -- "$name"; then continue; fi
    folder="$out/$name"
    printf '[filter]\ncu = %s\nfriction = %s\n[packing]\ngrains = %s\n' "$cu" "$friction" "$grains" >"$out/$name.toml"
    [ -f "$folder/packing.json" ] || "$voidwalk" pack "$out/$name.toml" --out "$folder" --quiet
    "$voidwalk" constrictions "$folder/grains.csv" --out "$folder/measured" --overwrite >/dev/null
    json="$folder/measured/constrictions.json"
    before=$(sed -n '/"before"/,/}/s/.*"void_ratio": *\([0-9.]*\),*/\1/p' "$folder/packing.json")
    after=$(sed -n '/"after"/,/}/s/.*"void_ratio": *\([0-9.]*\),*/\1/p' "$folder/packing.json")
    held=$(sed -n '/"after"/,/}/s/.*"coordination_held": *\([0-9.]*\),*/\1/p' "$folder/packing.json")
    grains_per_void=$(number "$json" grains_per_void)
    overlap=$(number "$json" merge_overlap)
    # The curve at every half percent, D0F = 1.
    {
        echo "# voidwalk: linear gradation, Cu $cu, friction $friction during compression, $grains grains, seed 1, merge_overlap $overlap"
        echo "percent_smaller,diameter_over_d0f"
        awk -F, 'NR > 1 {
            p = $1; d = $2
            while (NR > 2 && next_p <= p) {
                printf "%g,%.6f\n", next_p, d0 + (d - d0) * (p > p0 ? (next_p - p0) / (p - p0) : 0)
                next_p += 0.5
            }
            if (NR == 2) { printf "%g,%.6f\n", p, d; next_p = 0.5 }
            p0 = p; d0 = d
        }' "$folder/measured/constrictions.csv"
    } >"$out/shipped/$name.csv"
    {
        echo "[[filter]]"
        echo "name = \"$name\""
        echo "title = \"Linear gradation, Cu $cu, ${state/-/ }\""
        echo "cu = $cu"
        echo "void_ratio = $after"
        echo "void_ratio_source = \"voidwalk pack: $grains grains, friction $friction, seed 1 (scripts/paper/make_filters.sh)\""
        printf 'grains_per_void = %.4f\n' "$grains_per_void"
        echo "grains_per_void_source = \"Measured on the same packing (voids merged at an overlap of $overlap)\""
        echo "attribution = \"voidwalk's own packing and triangulation\""
        echo "licence = \"MIT OR Apache-2.0\""
    } >"$out/shipped/$name.toml"
    printf '| %s | %.4f, %.4f | %s | %.3f | %s | %.4f | %.3f | %.2f | %s | %.0f |\n' "$name" "$before" "$after" "$paper_e" \
        "$(number "$json" cu_csd)" "$paper_cu" "$(number "$json" 0)" "$grains_per_void" "$held" \
        "$(number "$folder/packing.json" steps)" "$(number "$folder/packing.json" seconds)"
done <<<"$filters"
cat "$out"/shipped/cu*.toml >"$out/shipped/filters.toml"
