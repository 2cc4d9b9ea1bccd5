// SPDX-License-Identifier: Apache-2.0
/// \file collision_tree_benchmark.h  The running collision search: the part of `trocar bench collision` whose
/// names other programs read.
#pragma once

#include "trocar/bench/benchmark.h"

namespace trocar::bench {

/// Adds the cases update_and_query_4000, update_and_query_43200 [ms], shaft_query_5130 [us], build_4000 [ms],
/// exact_fraction and paper_greedy_recall [-], and, where Embree is at hand, the ratios
/// update_and_query_4000/vs_embree and update_and_query_43200/vs_embree.
///
/// \return kBenchmarkWrong when an answer differs from brute force
base::Status AddTreeBenchmark(const BenchmarkOptions& options, BenchmarkResult& result);

}  // namespace trocar::bench
