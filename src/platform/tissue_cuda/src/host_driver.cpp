// SPDX-License-Identifier: Apache-2.0
#include "host_driver.h"

#include <cstdlib>
#include <cstring>
#include <iterator>
#include <map>

#include "block_executor.h"
#include "kernels/paper_layouts.h"
#include "kernels/tiled_chebyshev.h"

namespace trocar::tissue_cuda {
namespace {

// numbers of CUDA's driver for what can go wrong here
constexpr CudaCode kInvalidValue = 1, kNotFound = 500, kLaunchFailed = 719, kTooLargeToRunAtOnce = 720;
constexpr int kBlocksAtOnce = 2;

/// Blocks of memory and their sizes, so that a copy beyond an end is an error and not a crash.
std::map<CudaAddress, std::size_t>& Allocations() {
  static std::map<CudaAddress, std::size_t> allocations;
  return allocations;
}

/// A range as a pointer, where it lies inside one allocation; null otherwise.
void* Locate(CudaAddress address, std::size_t bytes) {
  const auto& allocations = Allocations();
  const auto after = allocations.upper_bound(address);
  if (after == allocations.begin()) return nullptr;
  const auto& [begin, size] = *std::prev(after);
  return address + bytes <= begin + size ? reinterpret_cast<void*>(address) : nullptr;
}

/// Stands for handles that are never looked into.
template <typename Handle>
CudaCode GiveHandle(Handle* handle) {
  static char something = 0;
  *handle = reinterpret_cast<Handle>(&something);
  return kCudaSuccess;
}

struct Entry {
  const char* name;
  bool (*run)(const void* args, unsigned blocks, unsigned threads);
  bool is_cooperative;
};

template <typename Kernel>
bool RunKernel(const void* args, unsigned blocks, unsigned threads) {
  // shuffled: a GPU promises no order
  return RunRaw<Kernel>(*static_cast<const typename Kernel::Args*>(args), blocks, threads, {5});
}

#define TROCAR_ENTRIES(Real, suffix)                                                             \
  {"trocar_global_" suffix, RunKernel<PaperGlobal<Real, RawMemory, false>>, false},              \
      {"trocar_coalesced_" suffix, RunKernel<PaperGlobal<Real, RawMemory, true>>, false},        \
      {"trocar_shared_" suffix, RunKernel<PaperShared<Real, RawMemory, false>>, false},          \
      {"trocar_shared_coalesced_" suffix, RunKernel<PaperShared<Real, RawMemory, true>>, false}, \
      {"trocar_tiled_resident_" suffix, RunKernel<TiledResident<Real, RawMemory>>, true}, {      \
    "trocar_tiled_streaming_" suffix, RunKernel<TiledStreaming<Real, RawMemory>>, true           \
  }
constexpr Entry kEntries[] = {TROCAR_ENTRIES(float, "f32"), TROCAR_ENTRIES(double, "f64")};
#undef TROCAR_ENTRIES

CudaCode Launch(CudaFunction function, unsigned blocks, unsigned threads, void** arguments,
                bool is_cooperative) {
  const auto* entry = reinterpret_cast<const Entry*>(function);
  if (entry->is_cooperative != is_cooperative) return kInvalidValue;
  if (is_cooperative && blocks > unsigned{kBlocksAtOnce} * kHostMultiprocessors) return kTooLargeToRunAtOnce;
  return entry->run(arguments[0], blocks, threads) ? kCudaSuccess : kLaunchFailed;
}

CudaCode FindKernel(CudaFunction* function, CudaModule, const char* name) {
  for (const Entry& entry : kEntries) {
    if (std::strcmp(entry.name, name) != 0) continue;
    *function = reinterpret_cast<CudaFunction>(const_cast<Entry*>(&entry));
    return kCudaSuccess;
  }
  return kNotFound;
}

CudaCode AnswerAttribute(int* value, int attribute, CudaDevice) {
  switch (attribute) {
    case kMultiprocessorCount:
      *value = kHostMultiprocessors;
      break;
    case kCapabilityMajor:
      *value = kOldestCapability / 10;
      break;
    case kCapabilityMinor:
      *value = kOldestCapability % 10;
      break;
    case kCooperativeLaunch:
      *value = 1;
      break;
    case kMaxSharedBytesPerBlock:
      *value = 1 << 20;
      break;
    default:
      *value = 0;
  }
  return kCudaSuccess;
}

CudaCode Allocate(CudaAddress* address, std::size_t bytes) {
  void* const memory = std::malloc(bytes);
  if (memory == nullptr) return kCudaOutOfMemory;
  std::memset(memory, 0xff, bytes);  // nothing may rely on what is there
  *address = reinterpret_cast<CudaAddress>(memory);
  Allocations()[*address] = bytes;
  return kCudaSuccess;
}

CudaCode Free(CudaAddress address) {
  if (Allocations().erase(address) == 0) return kInvalidValue;
  std::free(reinterpret_cast<void*>(address));
  return kCudaSuccess;
}

CudaCode Copy(void* to, const void* from, std::size_t bytes) {
  if (to == nullptr || from == nullptr) return kInvalidValue;
  std::memcpy(to, from, bytes);
  return kCudaSuccess;
}

}  // namespace

DriverFunctions HostDriver() {
  DriverFunctions driver;
  driver.init = [](unsigned) { return kCudaSuccess; };
  driver.get_version = [](int* version) { return *version = 1000, kCudaSuccess; };
  driver.get_error_name = [](CudaCode, const char** name) { return *name = "host executor", kCudaSuccess; };
  driver.get_device_count = [](int* count) { return *count = 1, kCudaSuccess; };
  driver.get_device = [](CudaDevice* device, int) { return *device = 0, kCudaSuccess; };
  driver.get_device_name = [](char* name, int length, CudaDevice) {
    std::strncpy(name, "host executor", static_cast<std::size_t>(length));
    return kCudaSuccess;
  };
  driver.get_device_memory = [](std::size_t* bytes, CudaDevice) { return *bytes = 0, kCudaSuccess; };
  driver.get_device_attribute = AnswerAttribute;
  driver.retain_context = [](CudaContext* context, CudaDevice) { return GiveHandle(context); };
  driver.release_context = [](CudaDevice) { return kCudaSuccess; };
  driver.set_context = [](CudaContext) { return kCudaSuccess; };
  driver.load_module = [](CudaModule* module, const void*) { return GiveHandle(module); };
  driver.unload_module = [](CudaModule) { return kCudaSuccess; };
  driver.get_function = FindKernel;
  driver.set_function_attribute = [](CudaFunction, int, int) { return kCudaSuccess; };
  driver.count_active_blocks = [](int* blocks, CudaFunction, int, std::size_t) {
    return *blocks = kBlocksAtOnce, kCudaSuccess;
  };
  driver.allocate = Allocate;
  driver.free = Free;
  driver.allocate_host = [](void** address, std::size_t bytes, unsigned) {
    *address = std::malloc(bytes);
    return *address != nullptr ? kCudaSuccess : kCudaOutOfMemory;
  };
  driver.free_host = [](void* address) { return std::free(address), kCudaSuccess; };
  driver.copy_to = [](CudaAddress to, const void* from, std::size_t bytes, CudaStream) {
    return Copy(Locate(to, bytes), from, bytes);
  };
  driver.copy_from = [](void* to, CudaAddress from, std::size_t bytes, CudaStream) {
    return Copy(to, Locate(from, bytes), bytes);
  };
  driver.copy_within = [](CudaAddress to, CudaAddress from, std::size_t bytes, CudaStream) {
    return Copy(Locate(to, bytes), Locate(from, bytes), bytes);
  };
  driver.fill_bytes = [](CudaAddress address, unsigned char value, std::size_t bytes, CudaStream) {
    void* const place = Locate(address, bytes);
    if (place == nullptr) return kInvalidValue;
    std::memset(place, value, bytes);
    return kCudaSuccess;
  };
  driver.launch = [](CudaFunction function, unsigned blocks, unsigned, unsigned, unsigned threads, unsigned,
                     unsigned, unsigned, CudaStream, void** arguments,
                     void**) { return Launch(function, blocks, threads, arguments, false); };
  driver.launch_cooperative = [](CudaFunction function, unsigned blocks, unsigned, unsigned, unsigned threads,
                                 unsigned, unsigned, unsigned, CudaStream, void** arguments) {
    return Launch(function, blocks, threads, arguments, true);
  };
  driver.create_stream = [](CudaStream* stream, unsigned) { return GiveHandle(stream); };
  driver.destroy_stream = [](CudaStream) { return kCudaSuccess; };
  driver.synchronize = [](CudaStream) { return kCudaSuccess; };
  driver.create_event = [](CudaEvent* event, unsigned) { return GiveHandle(event); };
  driver.destroy_event = [](CudaEvent) { return kCudaSuccess; };
  driver.record_event = [](CudaEvent, CudaStream) { return kCudaSuccess; };
  driver.elapsed = [](float* milliseconds, CudaEvent, CudaEvent) { return *milliseconds = 0, kCudaSuccess; };
  return driver;
}

DriverSource HostSource() {
  static constexpr unsigned char kNoCode[] = {0};  // the functions know their kernels by name
  DriverSource source;
  source.code = kNoCode;
  source.functions = HostDriver();
  return source;
}

}  // namespace trocar::tissue_cuda
