// SPDX-License-Identifier: Apache-2.0
/// \file kernels.cu  Entry points of the kernels, for nvcc alone. Compiled into a fat binary of its own that
/// the program carries as bytes (cmake/embed_gpu_code.cmake) and hands to the driver at run time.
#include "paper_layouts.h"
#include "tiled_chebyshev.h"

namespace trocar::tissue_cuda {
namespace {

/// Waits until every block of the grid has come here `generation` times. All blocks run at once: the launch
/// is cooperative.
__device__ void PassGridBarrier(unsigned int* arrived, unsigned int blocks, unsigned int& generation) {
  __syncthreads();
  ++generation;
  if (threadIdx.x == 0) {
    __threadfence();  // what this block wrote comes before its arrival
    atomicAdd(arrived, 1u);
    while (*static_cast<volatile unsigned int*>(arrived) < generation * blocks) {
    }
    __threadfence();  // and what others wrote before theirs is read behind it
  }
  __syncthreads();
}

template <typename Kernel, int kPhase, int kEnd>
__device__ __forceinline__ void RunPhases(const ThreadIndex& where, const typename Kernel::Args& args,
                                          typename Kernel::Shared& shared,
                                          typename Kernel::Registers& registers, unsigned int* arrived,
                                          unsigned int& generation) {
  if constexpr (kPhase < kEnd) {
    Kernel::template Run<kPhase>(where, args, shared, registers);
    if constexpr (Kernel::kBarrier[kPhase] == Barrier::kBlock) __syncthreads();
    if constexpr (Kernel::kBarrier[kPhase] == Barrier::kGrid)
      PassGridBarrier(arrived, where.blocks, generation);
    RunPhases<Kernel, kPhase + 1, kEnd>(where, args, shared, registers, arrived, generation);
  }
}

/// \param arrived  zero at launch; unused by kernels without grid barriers
template <typename Kernel>
__device__ __forceinline__ void RunKernel(const typename Kernel::Args& args, unsigned int* arrived) {
  extern __shared__ uint4 shared_bytes[];
  SharedLayout layout(reinterpret_cast<unsigned char*>(shared_bytes));
  typename Kernel::Shared shared = Kernel::MakeShared(layout, args);
  typename Kernel::Registers registers;
  const ThreadIndex where{threadIdx.x, blockIdx.x, blockDim.x, gridDim.x};
  unsigned int generation = 0;
  RunPhases<Kernel, 0, Kernel::kLoopBegin>(where, args, shared, registers, arrived, generation);
  if constexpr (Kernel::kLoopBegin < Kernel::kLoopEnd) {
    do {
      RunPhases<Kernel, Kernel::kLoopBegin, Kernel::kLoopEnd>(where, args, shared, registers, arrived,
                                                              generation);
    } while (Kernel::GoesOn(registers));
  }
  RunPhases<Kernel, Kernel::kLoopEnd, Kernel::kPhases>(where, args, shared, registers, arrived, generation);
}

}  // namespace
}  // namespace trocar::tissue_cuda

// The names stand in kernel_names.h too.
#define TROCAR_KERNEL(name, bound, ...)                                             \
  extern "C" __global__ void __launch_bounds__(256, bound)                          \
      name(const __grid_constant__ __VA_ARGS__::Args args, unsigned int* arrived) { \
    trocar::tissue_cuda::RunKernel<__VA_ARGS__>(args, arrived);                     \
  }
// `streaming` and `resident`: blocks that a multiprocessor should hold, which bounds a thread's registers
#define TROCAR_KERNELS(real, suffix, resident, streaming)                                      \
  TROCAR_KERNEL(trocar_global_##suffix, 1,                                                     \
                trocar::tissue_cuda::PaperGlobal<real, trocar::tissue_cuda::RawMemory, false>) \
  TROCAR_KERNEL(trocar_coalesced_##suffix, 1,                                                  \
                trocar::tissue_cuda::PaperGlobal<real, trocar::tissue_cuda::RawMemory, true>)  \
  TROCAR_KERNEL(trocar_shared_##suffix, 1,                                                     \
                trocar::tissue_cuda::PaperShared<real, trocar::tissue_cuda::RawMemory, false>) \
  TROCAR_KERNEL(trocar_shared_coalesced_##suffix, 1,                                           \
                trocar::tissue_cuda::PaperShared<real, trocar::tissue_cuda::RawMemory, true>)  \
  TROCAR_KERNEL(trocar_tiled_resident_##suffix, resident,                                      \
                trocar::tissue_cuda::TiledResident<real, trocar::tissue_cuda::RawMemory>)      \
  TROCAR_KERNEL(trocar_tiled_streaming_##suffix, streaming,                                    \
                trocar::tissue_cuda::TiledStreaming<real, trocar::tissue_cuda::RawMemory>)

TROCAR_KERNELS(float, f32, 3, 4)
TROCAR_KERNELS(double, f64, 2, 2)
