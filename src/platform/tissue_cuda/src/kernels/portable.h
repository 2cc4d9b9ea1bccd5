// SPDX-License-Identifier: Apache-2.0
/// \file portable.h  Types and functions that a kernel body may use: it is compiled for the GPU and, unchanged, for the host
/// executor (block_executor.h). C++17, because older CUDA compilers know no newer one.
///
/// A kernel is a struct with
///   Args, Shared, Registers    what all threads are given, what a block shares, what a thread keeps
///   MakeShared(allocator, args) the block's shared arrays
///   kPhases, kLoopBegin, kLoopEnd and kBarrier[kPhases]   its phases and the barrier behind each
///   Run<Phase>(where, args, shared, registers)            one phase of one thread
///   GoesOn(registers)          after phase kLoopEnd - 1: whether to repeat from kLoopBegin; the same in all
///   threads
/// A thread may read what another wrote only behind a barrier. Arrays are reached through Load, Store and
/// AtomicMax alone: raw pointers on the GPU, checked arrays in the executor.
///
/// Both sides round alike (no fused multiply-add, IEEE division and square root), so the executor's bits are
/// the GPU's bits.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#ifdef __CUDACC__
#define TROCAR_HD __host__ __device__ __forceinline__
#else
#define TROCAR_HD inline
#endif

namespace trocar::tissue_cuda {

/// Where a thread stands.
struct ThreadIndex {
  std::uint32_t thread, block, threads_per_block, blocks;
};

enum class Barrier { kNone, kBlock, kGrid };

/// Three numbers; displacements, positions or forces.
template <typename Real>
struct Triple {
  Real x, y, z;
};
/// Four numbers that move as one 16-byte access in single precision.
template <typename Real>
struct alignas(16) Quad {
  Real x, y, z, w;
};

template <typename Real>
TROCAR_HD Triple<Real> operator+(Triple<Real> a, Triple<Real> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename Real>
TROCAR_HD Triple<Real> operator-(Triple<Real> a, Triple<Real> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename Real>
TROCAR_HD Triple<Real> operator*(Real s, Triple<Real> a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <typename Real>
TROCAR_HD Real Dot(Triple<Real> a, Triple<Real> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Real>
TROCAR_HD Triple<Real> First3(Quad<Real> q) {
  return {q.x, q.y, q.z};
}

template <typename Real>
TROCAR_HD Real Larger(Real a, Real b) {
  return a > b ? a : b;
}

TROCAR_HD float SquareRoot(float value) {
#ifdef __CUDA_ARCH__
  return __fsqrt_rn(value);
#else
  return std::sqrt(value);
#endif
}
TROCAR_HD double SquareRoot(double value) {
#ifdef __CUDA_ARCH__
  return __dsqrt_rn(value);
#else
  return std::sqrt(value);
#endif
}

/// Order-preserving whole number of a float or double that is >= 0, or of NaN, which then exceeds all: a
/// maximum of such keys needs no order and forgets no NaN. Stored in 64 bits for both.
using Key = unsigned long long;
TROCAR_HD Key ToKey(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
TROCAR_HD Key ToKey(double value) {
  Key bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
template <typename Real>
TROCAR_HD Real FromKey(Key key);
template <>
TROCAR_HD float FromKey<float>(Key key) {
  const auto bits = static_cast<std::uint32_t>(key);
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}
template <>
TROCAR_HD double FromKey<double>(Key key) {
  double value;
  std::memcpy(&value, &key, sizeof value);
  return value;
}

/// Arrays as the GPU sees them.
struct RawMemory {
  template <typename T>
  using Array = T*;
};

template <typename T>
TROCAR_HD T Load(const T* array, std::size_t i) {
  return array[i];
}
template <typename T>
TROCAR_HD void Store(T* array, std::size_t i, T value) {
  array[i] = value;
}
TROCAR_HD void AtomicMax(Key* array, std::size_t i, Key value) {
#ifdef __CUDA_ARCH__
  atomicMax(array + i, value);
#else
  array[i] = Larger(array[i], value);
#endif
}
/// Whether an optional array was given.
template <typename T>
TROCAR_HD bool Exists(const T* array) {
  return array != nullptr;
}

/// Maximum over the threads of a warp, in each of them; outside the GPU a thread is alone. Every thread of
/// the warp must come here.
TROCAR_HD Key WarpMax(Key value) {
#ifdef __CUDA_ARCH__
  for (int distance = 16; distance > 0; distance /= 2) {
    const Key other = __shfl_xor_sync(0xffffffffu, value, distance);
    value = Larger(value, other);
  }
#endif
  return value;
}
/// Whether this thread speaks for its warp after WarpMax.
TROCAR_HD bool SpeaksForWarp(const ThreadIndex& where) {
#ifdef __CUDA_ARCH__
  return where.thread % 32 == 0;
#else
  (void)where;
  return true;
#endif
}

/// Counts the bytes of a block's shared arrays, or lays them out behind one another.
class SharedLayout {
 public:
  using Memory = RawMemory;
  TROCAR_HD explicit SharedLayout(unsigned char* begin) : begin_(begin) {}
  template <typename T>
  TROCAR_HD T* Array(std::size_t count) {
    bytes_ = (bytes_ + 15) / 16 * 16;
    T* const array = begin_ == nullptr ? nullptr : reinterpret_cast<T*>(begin_ + bytes_);
    bytes_ += count * sizeof(T);
    return array;
  }
  TROCAR_HD std::size_t Bytes() const { return (bytes_ + 15) / 16 * 16; }

 private:
  unsigned char* begin_;
  std::size_t bytes_ = 0;
};

}  // namespace trocar::tissue_cuda
