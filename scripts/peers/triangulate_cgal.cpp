// Regular triangulation of a periodic packing by CGAL, for scripts/peers/compare_triangulation.sh.
//
// triangulate_cgal PACKING.csv MARGIN REPEATS OUT: the grains and their images within MARGIN of the
// largest grain around the cell are triangulated; the shortest time of REPEATS is printed; one
// tetrahedron of each class of translates is written, a line each: grain and shift of each corner
// relative to the least, ascending.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Regular_triangulation_cell_base_3.h>
#include <CGAL/Regular_triangulation_vertex_base_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<unsigned, Kernel,
                                                               CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
using CellBase = CGAL::Regular_triangulation_cell_base_3<Kernel>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Regular = CGAL::Regular_triangulation_3<Kernel, Structure>;
using Corner = std::array<int, 4>; // grain, shift along x, y, z

int main(int argc, char **argv) {
  if (argc != 5) {
    std::cerr << "triangulate_cgal PACKING.csv MARGIN REPEATS OUT\n";
    return 2;
  }
  std::ifstream in(argv[1]);
  std::string line;
  std::getline(in, line);
  std::array<double, 3> cell;
  if (std::sscanf(line.c_str(), "# cell_mm = %lf, %lf, %lf", &cell[0], &cell[1], &cell[2]) != 3) {
    std::cerr << "no periodic cell in " << argv[1] << "\n";
    return 2;
  }
  std::getline(in, line); // header
  std::vector<std::array<double, 4>> grains;
  double largest = 0;
  while (std::getline(in, line)) {
    std::array<double, 4> g;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &g[0], &g[1], &g[2], &g[3]) != 4)
      continue;
    largest = std::max(largest, g[3]);
    grains.push_back(g);
  }
  const double margin = std::atof(argv[2]) * largest;
  std::vector<std::pair<Regular::Weighted_point, unsigned>> points;
  std::vector<Corner> identity;
  for (unsigned i = 0; i < grains.size(); ++i)
    for (int a = -1; a <= 1; ++a)
      for (int b = -1; b <= 1; ++b)
        for (int c = -1; c <= 1; ++c) {
          const std::array<int, 3> shift{a, b, c};
          std::array<double, 3> p;
          bool inside = true;
          for (int axis = 0; axis < 3; ++axis) {
            p[axis] = grains[i][axis] + shift[axis] * cell[axis];
            inside = inside && p[axis] >= -margin && p[axis] <= cell[axis] + margin;
          }
          if (!inside)
            continue;
          const double r = 0.5 * grains[i][3];
          points.push_back({Regular::Weighted_point({p[0], p[1], p[2]}, r * r), unsigned(identity.size())});
          identity.push_back({int(i), a, b, c});
        }
  double best = 1e300;
  Regular triangulation;
  for (int repeat = 0; repeat < std::atoi(argv[3]); ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    Regular fresh(points.begin(), points.end());
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    triangulation.swap(fresh);
  }
  std::set<std::string> lines;
  for (auto it = triangulation.finite_cells_begin(); it != triangulation.finite_cells_end(); ++it) {
    std::array<Corner, 4> corners;
    for (int k = 0; k < 4; ++k)
      corners[k] = identity[it->vertex(k)->info()];
    std::sort(corners.begin(), corners.end());
    const Corner first = corners[0];
    if (first[1] != 0 || first[2] != 0 || first[3] != 0)
      continue;
    std::ostringstream text;
    for (const Corner &c : corners)
      text << c[0] << ' ' << c[1] << ' ' << c[2] << ' ' << c[3] << ' ';
    lines.insert(text.str());
  }
  std::ofstream out(argv[4]);
  for (const auto &text : lines)
    out << text << "\n";
  std::cout << "CGAL: " << grains.size() << " grains, " << points.size() << " points with images, " << lines.size()
            << " tetrahedra; triangulate " << best << " s\n";
  return out ? 0 : 1;
}
