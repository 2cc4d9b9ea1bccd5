// SPDX-License-Identifier: Apache-2.0
/// \file node_vectors.h  Sums and combinations of node vectors in chunks of fixed size.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels.h"
#include "trocar/math/aligned_vector.h"
#include "trocar/math/vector.h"
#include "workers.h"

namespace trocar::tissue {

/// Nodes a thread takes at a time; fixed, so that sums do not depend on the number of threads.
inline constexpr std::uint32_t kVectorChunk = 896;

inline Float4 ToFloat(const math::Vec3& v) noexcept {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0.0f};
}
inline math::Vec3 ToDouble(const Float4& v) noexcept {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
/// from + share step
inline Double4 Advance(const Double4& from, double share, const Float4& step) noexcept {
  return {from.x + share * static_cast<double>(step.x), from.y + share * static_cast<double>(step.y),
          from.z + share * static_cast<double>(step.z), 0.0};
}

/// Calls work(first, last, chunk) for every chunk of `count` nodes; chunks begin at whole slices.
template <typename Work>
std::uint32_t ForEachNodeChunk(Workers& workers, std::size_t count, const Work& work) noexcept {
  const auto n = static_cast<std::uint32_t>(count);
  const std::uint32_t size =
      std::max(kVectorChunk, (n / Workers::kMaxChunks / kSliceNodes + 1) * kSliceNodes);
  const std::uint32_t chunks = (n + size - 1) / size;
  workers.Run(chunks,
              [&](std::uint32_t chunk) { work(chunk * size, std::min(n, (chunk + 1) * size), chunk); });
  return chunks;
}

/// The larger; NaN where one is.
inline float LargerOrNan(float a, float b) noexcept {
  return a >= b || std::isnan(a) ? a : b;
}

/// a . b of all nodes, in double precision and in an order that the threads do not change.
inline double CalcDot(const Kernels& kernels, Workers& workers, const math::AlignedVector<Float4>& a,
                      const math::AlignedVector<Float4>& b) noexcept {
  std::array<double, Workers::kMaxChunks> parts;
  const std::uint32_t chunks =
      ForEachNodeChunk(workers, a.size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t chunk) {
        parts[chunk] = kernels.vectors.dot(a.data(), b.data(), first, last);
      });
  double sum = 0;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) sum += parts[chunk];
  return sum;
}

struct DotAndLongest {
  double dot;
  double longest;  ///< of the second vector
};
/// a . b and the length of the longest of b's vectors, as by CalcDot() and FindLongest(), in one pass.
///
/// \param finish(first, last)  is called for each chunk of the nodes before it is read
template <typename Finish>
DotAndLongest CalcDotAndLongest(const Kernels& kernels, Workers& workers,
                                const math::AlignedVector<Float4>& a, const math::AlignedVector<Float4>& b,
                                const Finish& finish) noexcept {
  std::array<double, Workers::kMaxChunks> dots;
  std::array<float, Workers::kMaxChunks> largest2;
  const std::uint32_t chunks =
      ForEachNodeChunk(workers, a.size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t chunk) {
        finish(first, last);
        dots[chunk] = kernels.vectors.dot(a.data(), b.data(), first, last);
        largest2[chunk] = kernels.vectors.find_largest2(b.data(), first, last);
      });
  double sum = 0;
  float most = 0;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
    sum += dots[chunk];
    most = LargerOrNan(most, largest2[chunk]);
  }
  return {sum, std::sqrt(static_cast<double>(most))};
}
inline DotAndLongest CalcDotAndLongest(const Kernels& kernels, Workers& workers,
                                       const math::AlignedVector<Float4>& a,
                                       const math::AlignedVector<Float4>& b) noexcept {
  return CalcDotAndLongest(kernels, workers, a, b, [](std::uint32_t, std::uint32_t) {});
}

/// Length of the longest of all nodes' vectors; NaN where one is.
inline double FindLongest(const Kernels& kernels, Workers& workers,
                          const math::AlignedVector<Float4>& v) noexcept {
  std::array<float, Workers::kMaxChunks> parts;
  const std::uint32_t chunks =
      ForEachNodeChunk(workers, v.size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t chunk) {
        parts[chunk] = kernels.vectors.find_largest2(v.data(), first, last);
      });
  float largest2 = 0;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) largest2 = LargerOrNan(largest2, parts[chunk]);
  return std::sqrt(static_cast<double>(largest2));
}

}  // namespace trocar::tissue
