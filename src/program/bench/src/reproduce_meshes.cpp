// SPDX-License-Identifier: Apache-2.0
/// \file reproduce_meshes.cpp  Table 1: the meshes of the paper's GPU experiment.
#include "trocar/bench/experiment.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/primitives.h"

namespace trocar::bench {

ExperimentResult ReproduceTable1(const ExperimentOptions& options, ExperimentStore&) {
  struct Printed {
    int side;
    double triangles, edges, points;
  };
  constexpr Printed kPrinted[] = {{16, 450, 704, 256},
                                  {112, 24642, 37184, 12544},
                                  {176, 61250, 92224, 30976},
                                  {208, 85698, 128960, 43264}};
  Experiment experiment{"table1",
                        "Table 1: characteristics of the meshes",
                        "Square grids of n x n points with one diagonal a cell, made and counted: the points "
                        "and triangles of the "
                        "paper's four meshes are those of n = 16, 112, 176 and 208.",
                        {},
                        {"The printed edges are points + triangles - 2, one fewer than the edges of a disc "
                         "have by Euler's formula, "
                         "points + triangles - 1. Counted edges are listed."},
                        {}};
  ExperimentTable table{
      "Points, edges and triangles",
      {"mesh", "n", "points, paper", "points", "triangles, paper", "triangles", "edges, paper", "edges"},
      {}};
  PlotLine paper{"edges, paper", {}}, ours{"edges", {}}, triangles{"triangles", {}};
  for (const Printed& printed : kPrinted) {
    const geometry::TriangleMesh mesh = geometry::MakeGrid(printed.side, 1.0);
    const auto edges = static_cast<double>(geometry::FindEdges(mesh.triangles).size());
    const auto points = static_cast<double>(mesh.positions.size());
    table.rows.push_back({"Mesh " + std::to_string(table.rows.size() + 1),
                          {double(printed.side), 9},
                          {printed.points, 9},
                          {points, 9},
                          {printed.triangles, 9},
                          {static_cast<double>(mesh.triangles.size()), 9},
                          {printed.edges, 9},
                          {edges, 9}});
    paper.points.push_back({points, printed.edges});
    ours.points.push_back({points, edges});
    triangles.points.push_back({points, static_cast<double>(mesh.triangles.size())});
    options.progress(static_cast<double>(table.rows.size()) / 4);
  }
  experiment.tables = {table};
  experiment.plots = {{{"Edges and triangles over points", "points", "count"}, {paper, ours, triangles}}};
  return experiment;
}

}  // namespace trocar::bench
