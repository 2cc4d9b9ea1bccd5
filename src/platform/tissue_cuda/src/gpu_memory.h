// SPDX-License-Identifier: Apache-2.0
/// \file gpu_memory.h  Arrays on the GPU and staging memory on the host, owned together. The first error is
/// kept, so that many arrays can be asked for and the answer looked at once.
#pragma once

#include <cstring>
#include <vector>

#include "driver.h"
#include "kernels/portable.h"

namespace trocar::tissue_cuda {

class GpuMemory {
 public:
  using Memory = RawMemory;
  explicit GpuMemory(Gpu& gpu) : gpu_(&gpu) {}
  ~GpuMemory() {
    (void)gpu_->Enter();  // after an error too: what the driver still takes back is not lost
    for (const CudaAddress address : device_) gpu_->Free(address);
    for (void* const address : host_) gpu_->FreeHost(address);
  }
  GpuMemory(const GpuMemory&) = delete;
  GpuMemory& operator=(const GpuMemory&) = delete;

  const base::Status& GetStatus() const noexcept { return status_; }

  /// Address on the GPU, never to be followed on the host.
  template <typename T>
  T* Array(const char*, std::size_t count) {
    if (!status_ || count == 0) return nullptr;
    const base::Result<CudaAddress> address = gpu_->Allocate(count * sizeof(T));
    if (!address) {
      status_ = address.error();
      return nullptr;
    }
    device_.push_back(*address);
    return reinterpret_cast<T*>(*address);
  }
  /// Copied when this returns.
  template <typename T>
  T* Filled(const char* name, const std::vector<T>& values) {
    T* const array = Array<T>(name, values.size());
    if (!status_ || array == nullptr) return nullptr;
    status_ = gpu_->CopyToGpu(reinterpret_cast<CudaAddress>(array), values.data(), values.size() * sizeof(T));
    if (status_) status_ = gpu_->Finish();
    return array;
  }
  /// Staging memory on the host.
  template <typename T>
  T* HostArray(std::size_t count) {
    if (!status_ || count == 0) return nullptr;
    const base::Result<void*> address = gpu_->AllocateHost(count * sizeof(T));
    if (!address) {
      status_ = address.error();
      return nullptr;
    }
    host_.push_back(*address);
    return static_cast<T*>(*address);
  }

 private:
  Gpu* gpu_;
  base::Status status_;
  std::vector<CudaAddress> device_;
  std::vector<void*> host_;
};

}  // namespace trocar::tissue_cuda
