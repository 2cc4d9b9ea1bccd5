// SPDX-License-Identifier: Apache-2.0
// The parts of a volume that hang together, by rows: each row is cut into runs of one side, and runs that
// touch are put into one set (Galler and Fischer, "An improved equivalence algorithm", CACM 1964).
#include <algorithm>
#include <numeric>

#include "trocar/meshing/volume.h"

namespace trocar::meshing {
namespace {

/// Samples begin to end - 1 of one row.
struct Run {
  int begin = 0, end = 0;
  std::size_t row = 0;
};

/// Runs of one side, and which of them hang together.
class Parts {
 public:
  Parts(const ScalarVolume& volume, bool inside) {
    const auto rows = static_cast<std::size_t>(volume.size[1]) * volume.size[2];
    for (std::size_t row = 0; row < rows; ++row) {
      starts_.push_back(static_cast<std::uint32_t>(runs_.size()));
      const float* values = &volume.values[row * static_cast<std::size_t>(volume.size[0])];
      for (int i = 0; i < volume.size[0]; ++i) {
        if ((values[i] > 0) != inside) continue;
        const int begin = i;
        while (i < volume.size[0] && (values[i] > 0) == inside) ++i;
        runs_.push_back({begin, i, row});
      }
    }
    starts_.push_back(static_cast<std::uint32_t>(runs_.size()));
    parent_.resize(runs_.size());
    std::iota(parent_.begin(), parent_.end(), 0u);
    const auto layer = static_cast<std::size_t>(volume.size[1]);
    for (std::size_t row = 0; row < rows; ++row) {
      if (row % layer != 0) JoinRows(row - 1, row);
      if (row >= layer) JoinRows(row - layer, row);
    }
  }

  /// Runs that are not of the largest part; the first of several that are as large is kept.
  std::vector<Run> FindLesser() {
    std::vector<std::size_t> sizes(runs_.size(), 0);
    for (std::uint32_t r = 0; r < runs_.size(); ++r)
      sizes[FindRoot(r)] += static_cast<std::size_t>(runs_[r].end - runs_[r].begin);
    const auto largest =
        static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    std::vector<Run> lesser;
    for (std::uint32_t r = 0; r < runs_.size(); ++r) {
      if (FindRoot(r) != largest) lesser.push_back(runs_[r]);
    }
    return lesser;
  }

 private:
  std::uint32_t FindRoot(std::uint32_t r) {
    while (parent_[r] != r) r = parent_[r] = parent_[parent_[r]];
    return r;
  }
  void JoinRows(std::size_t one, std::size_t other) {
    std::uint32_t a = starts_[one], b = starts_[other];
    while (a < starts_[one + 1] && b < starts_[other + 1]) {
      if (runs_[a].begin < runs_[b].end && runs_[b].begin < runs_[a].end) {
        const std::uint32_t root_a = FindRoot(a), root_b = FindRoot(b);
        parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
      }
      runs_[a].end < runs_[b].end ? ++a : ++b;
    }
  }

  std::vector<Run> runs_;
  std::vector<std::uint32_t> starts_, parent_;
};

}  // namespace

void KeepLargestPart(ScalarVolume& volume) {
  const auto other_side = static_cast<float>(0.5 * volume.spacing);
  for (const bool inside : {true, false}) {
    for (const Run& run : Parts(volume, inside).FindLesser()) {
      float* values = &volume.values[run.row * static_cast<std::size_t>(volume.size[0])];
      std::fill(values + run.begin, values + run.end, inside ? -other_side : other_side);
    }
  }
}

}  // namespace trocar::meshing
