// SPDX-License-Identifier: Apache-2.0
/// \file driver.h  CUDA's driver, found when the program runs: a program on a computer without one starts as
/// ever, and learns in one line why there is no GPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "driver_functions.h"
#include "trocar/base/result.h"
#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::tissue_cuda {

/// Where driver and GPU code come from; tests give a stand-in.
struct DriverSource {
  std::string file = "libcuda.so.1";
  std::optional<DriverFunctions> functions;  ///< taken instead of the library where given
  std::span<const unsigned char> code;  ///< fat binary of kernels/kernels.cu; empty in a build without nvcc
  int code_version = 0;                 ///< CUDA version that compiled it, 1000 major + 10 minor
};
/// Driver source of this build: the system's driver, and the GPU code that the build carries.
DriverSource BuiltInSource();

/// Oldest GPU that the kernels run on (Turing), 10 major + minor.
inline constexpr int kOldestCapability = 75;

/// The driver's functions without a GPU; enough to say what there is.
base::Result<DriverFunctions> LoadDriver(const DriverSource& source);

/// Success or error of a call of the driver.
/// \param what  the attempt, for the message: "copying positions to the GPU"
base::Status CheckCall(const DriverFunctions& driver, CudaCode code, const char* what);

/// Shape of a launch.
struct LaunchShape {
  std::uint32_t blocks = 1, threads = 1, shared_bytes = 0;
  bool is_cooperative = false;  ///< all blocks run at once and may wait for each other
};

/// One GPU, opened: context, kernels, one queue of work.
class Gpu {
 public:
  static base::Result<std::unique_ptr<Gpu>> Open(const DriverSource& source);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  const GpuInformation& Information() const noexcept { return information_; }
  const DriverFunctions& Functions() const noexcept { return driver_; }

  /// Makes this GPU the calling thread's.
  base::Status Enter() noexcept;
  base::Result<CudaFunction> FindKernel(const std::string& name);
  /// Blocks of a kernel that the whole GPU runs at once; 0 where a block's shared memory is more than it has.
  base::Result<std::uint32_t> CountResidentBlocks(CudaFunction kernel, std::uint32_t threads,
                                                  std::uint32_t shared_bytes);

  base::Result<CudaAddress> Allocate(std::size_t bytes);
  void Free(CudaAddress address) noexcept;
  /// Memory of the host that the GPU copies from and to by itself.
  base::Result<void*> AllocateHost(std::size_t bytes);
  void FreeHost(void* address) noexcept;

  // these join the queue and return at once
  base::Status CopyToGpu(CudaAddress to, const void* from, std::size_t bytes) noexcept;
  base::Status CopyFromGpu(void* to, CudaAddress from, std::size_t bytes) noexcept;
  base::Status CopyWithinGpu(CudaAddress to, CudaAddress from, std::size_t bytes) noexcept;
  base::Status Clear(CudaAddress address, std::size_t bytes) noexcept;
  /// \param arguments  addresses of the kernel's arguments
  base::Status Launch(CudaFunction kernel, const LaunchShape& shape, void** arguments) noexcept;

  /// Waits until the queue is empty.
  base::Status Finish() noexcept;

  /// Marks on the GPU's clock: 0 to kMarks - 1.
  static constexpr int kMarks = 4;
  base::Status Mark(int mark) noexcept;
  /// Time between two marks that have passed [s]; 0 where the driver cannot say.
  double SecondsBetween(int first, int second) const noexcept;

 private:
  Gpu() = default;
  base::Status Start(const DriverSource& source);

  DriverFunctions driver_;
  GpuInformation information_;
  CudaDevice device_ = 0;
  CudaContext context_ = nullptr;
  CudaModule module_ = nullptr;
  CudaStream stream_ = nullptr;
  CudaEvent marks_[kMarks] = {};
  int max_shared_bytes_ = 0;
};

/// Description of the GPU that can be used, without opening it; else an error that says why there is none.
base::Result<GpuInformation> FindGpu(const DriverSource& source);

}  // namespace trocar::tissue_cuda
