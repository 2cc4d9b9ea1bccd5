// SPDX-License-Identifier: Apache-2.0
/// \file node_vectors.h  Sums and combinations of node vectors in chunks of fixed size.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kernels.h"
#include "workers.h"

namespace trocar::tissue {

/// Nodes a thread takes at a time; fixed, so that sums do not depend on the number of threads.
inline constexpr std::uint32_t kVectorChunk = 2048;

/// Calls work(first, last, chunk) for every chunk of `count` nodes.
template <typename Work>
std::uint32_t ForEachNodeChunk(Workers& workers, std::size_t count, const Work& work) noexcept {
  const auto n = static_cast<std::uint32_t>(count);
  const std::uint32_t size = std::max(kVectorChunk, n / Workers::kMaxChunks + 1);
  const std::uint32_t chunks = (n + size - 1) / size;
  workers.Run(chunks,
              [&](std::uint32_t chunk) { work(chunk * size, std::min(n, (chunk + 1) * size), chunk); });
  return chunks;
}

/// Sum over all nodes of value(i), in double precision and in an order that the threads do not change.
template <typename Value>
double SumOverNodes(Workers& workers, std::size_t count, const Value& value) noexcept {
  std::array<double, Workers::kMaxChunks> parts;
  const std::uint32_t chunks =
      ForEachNodeChunk(workers, count, [&](std::uint32_t first, std::uint32_t last, std::uint32_t chunk) {
        // four partial sums: the additions of one would wait for each other
        double sums[4] = {};
        for (std::uint32_t i = first; i < last; ++i) sums[i % 4] += value(i);
        parts[chunk] = (sums[0] + sums[1]) + (sums[2] + sums[3]);
      });
  double sum = 0;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) sum += parts[chunk];
  return sum;
}

/// Largest value(i) of all nodes, not below 0; NaN where one is.
template <typename Value>
double FindLargestOfNodes(Workers& workers, std::size_t count, const Value& value) noexcept {
  std::array<double, Workers::kMaxChunks> parts;
  const std::uint32_t chunks =
      ForEachNodeChunk(workers, count, [&](std::uint32_t first, std::uint32_t last, std::uint32_t chunk) {
        double largest = 0;
        for (std::uint32_t i = first; i < last; ++i) {
          const double here = value(i);
          if (!(here <= largest)) largest = here;
        }
        parts[chunk] = largest;
      });
  double largest = 0;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
    if (!(parts[chunk] <= largest)) largest = parts[chunk];
  }
  return largest;
}

inline double Dot(const Float4& a, const Float4& b) noexcept {
  return static_cast<double>(a.x * b.x + a.y * b.y + a.z * b.z);
}

}  // namespace trocar::tissue
