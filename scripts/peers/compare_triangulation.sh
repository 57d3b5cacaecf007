#!/bin/sh
# Triangulates packings beside CGAL: the same tetrahedra, and both times.
#
#   scripts/peers/compare_triangulation.sh PACKING [PACKING ...]      (CSV or LAMMPS text dump, periodic)
#
# Installs CGAL's headers from Debian where they are missing (root). Fails if one tetrahedron differs.
# Times are the shortest of nine, one core each; CGAL triangulates the grains and their images within
# MARGIN (1.5) of the largest grain around the cell, as it must to get a periodic answer.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
margin=${MARGIN:-1.5}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

[ $# -gt 0 ] || { sed -n '2,8p' "$0"; exit 2; }
[ -e /usr/include/CGAL/Regular_triangulation_3.h ] || {
    apt-get update -qq
    apt-get install -y -qq libcgal-dev g++
}
g++ -O3 -DNDEBUG -march=native -std=c++17 "$here/triangulate_cgal.cpp" -o "$work/cgal" -lgmp -lmpfr
failed=0
for packing in "$@"; do
    packing=$(realpath "$packing")
    # The same coordinates for both, wrapped into the cell.
    (cd "$here/../.." && cargo bench -q --bench triangulation -- "$packing" --grains "$work/grains.csv" >/dev/null)
    # One core: the measuring of constrictions would take more.
    (cd "$here/../.." && RAYON_NUM_THREADS=1 cargo bench -q --bench triangulation -- \
        "$work/grains.csv" --tetrahedra "$work/ours") | sed "s|$work/grains.csv|voidwalk, $packing|"
    "$work/cgal" "$work/grains.csv" "$margin" 9 "$work/theirs"
    LC_ALL=C sort "$work/ours" >"$work/a"
    LC_ALL=C sort "$work/theirs" >"$work/b"
    if cmp -s "$work/a" "$work/b"; then
        echo "same $(wc -l <"$work/a") tetrahedra"
    else
        echo "DIFFERENT: $(comm -23 "$work/a" "$work/b" | wc -l) only here, $(comm -13 "$work/a" "$work/b" | wc -l) only CGAL"
        failed=1
    fi
done
exit $failed
