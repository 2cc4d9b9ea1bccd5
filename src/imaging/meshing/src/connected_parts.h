// SPDX-License-Identifier: Apache-2.0
/// \file connected_parts.h  Which samples of a lattice hang together, by rows: each row is cut into runs, and runs that
/// touch are put into one set (Galler and Fischer, "An improved equivalence algorithm", CACM 1964).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace trocar::meshing {

/// Samples begin to end - 1 of one row.
struct Run {
  int begin = 0, end = 0;
  std::size_t row = 0;
};

/// 6-connected parts of the samples that belong to a set.
class ConnectedParts {
 public:
  /// \param size  samples along each axis, the first one fastest; rows are numbered through all layers
  /// \param belongs  (row, index along the row) -> bool
  template <typename Belongs>
  ConnectedParts(const std::array<int, 3>& size, const Belongs& belongs) {
    const auto rows = static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
    for (std::size_t row = 0; row < rows; ++row) {
      starts_.push_back(static_cast<std::uint32_t>(runs_.size()));
      for (int i = 0; i < size[0]; ++i) {
        if (!belongs(row, i)) continue;
        const int begin = i;
        while (i < size[0] && belongs(row, i)) ++i;
        runs_.push_back({begin, i, row});
      }
    }
    starts_.push_back(static_cast<std::uint32_t>(runs_.size()));
    Join(rows, static_cast<std::size_t>(size[1]));
  }

  /// Samples of each part, the largest first.
  std::vector<std::size_t> CountSamples();

  /// Runs that are not of the largest part; the first of several that are as large is kept.
  std::vector<Run> FindLesser();

 private:
  void Join(std::size_t rows, std::size_t rows_of_a_layer);
  void JoinRows(std::size_t one, std::size_t other);
  std::uint32_t FindRoot(std::uint32_t run);
  std::vector<std::size_t> SizesByRoot();

  std::vector<Run> runs_;
  std::vector<std::uint32_t> starts_, parent_;
};

}  // namespace trocar::meshing
