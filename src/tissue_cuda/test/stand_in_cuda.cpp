// SPDX-License-Identifier: Apache-2.0
/// \file stand_in_cuda.cpp  A libcuda.so.1 for tests. Its GPU is the host executor: copies copy, launches run
/// the kernels that the real GPU would run, from the arguments that it would get. The environment variable
/// TROCAR_STAND_IN_CUDA, read by cuInit, says what goes wrong:
///   init=CODE version=N devices=N capability=N memory=BYTES blocks=N   answers (blocks: at once on a
///   multiprocessor) load=CODE                                                        of cuModuleLoadData
///   fail=FUNCTION:N:CODE                                             the Nth call of a function fails, and
///                                                                    every call after it, as on a real GPU
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <string>

#include "block_executor.h"
#include "driver_functions.h"
#include "kernels/paper_layouts.h"
#include "kernels/tiled_chebyshev.h"

#define TROCAR_API extern "C" __attribute__((visibility("default")))

namespace {

using namespace trocar::tissue_cuda;  // NOLINT: one file, one purpose

struct Plan {
  int init = 0, version = 13000, devices = 1, capability = 90, blocks = 2, load = 0;
  std::size_t memory = std::size_t{1} << 30;
  std::string fail_function;
  int fail_call = 0, fail_code = 0;

  std::map<std::string, int> calls;
  int sticky = 0;
  std::map<CudaAddress, std::size_t> allocations;
  std::size_t allocated = 0;
  std::map<std::string, int> kernels;  // names asked for
};

Plan& ThePlan() {
  static Plan plan;
  return plan;
}

void ReadPlan() {
  Plan plan;
  plan.allocations = ThePlan().allocations;
  plan.allocated = ThePlan().allocated;
  const char* text = std::getenv("TROCAR_STAND_IN_CUDA");
  std::istringstream words(text != nullptr ? text : "");
  for (std::string word; words >> word;) {
    const auto equals = word.find('=');
    const std::string key = word.substr(0, equals), value = word.substr(equals + 1);
    if (key == "init") plan.init = std::stoi(value);
    if (key == "version") plan.version = std::stoi(value);
    if (key == "devices") plan.devices = std::stoi(value);
    if (key == "capability") plan.capability = std::stoi(value);
    if (key == "blocks") plan.blocks = std::stoi(value);
    if (key == "load") plan.load = std::stoi(value);
    if (key == "memory") plan.memory = std::stoul(value);
    if (key == "fail") {
      const auto first = value.find(':'), second = value.find(':', first + 1);
      plan.fail_function = value.substr(0, first);
      plan.fail_call = std::stoi(value.substr(first + 1, second - first - 1));
      plan.fail_code = std::stoi(value.substr(second + 1));
    }
  }
  ThePlan() = std::move(plan);
}

/// Counts a call; its code if it is to fail.
int Count(const char* function) {
  Plan& plan = ThePlan();
  if (plan.sticky != 0) return plan.sticky;
  if (++plan.calls[function] == plan.fail_call && plan.fail_function == function)
    plan.sticky = plan.fail_code;
  return plan.sticky;
}

/// Address of an allocation's byte, where the whole range lies inside one; null otherwise.
void* Locate(CudaAddress address, std::size_t bytes) {
  auto& allocations = ThePlan().allocations;
  auto after = allocations.upper_bound(address);
  if (after == allocations.begin()) return nullptr;
  const auto& [begin, size] = *std::prev(after);
  return address + bytes <= begin + size ? reinterpret_cast<void*>(address) : nullptr;
}

using Run = bool (*)(const void* args, unsigned blocks, unsigned threads);

template <typename Kernel>
bool RunOne(const void* args, unsigned blocks, unsigned threads) {
  // shuffled: a real GPU promises no order
  return RunRaw<Kernel>(*static_cast<const typename Kernel::Args*>(args), blocks, threads, {5});
}

struct Entry {
  const char* name;
  Run run;
  bool is_cooperative;
};

template <typename Real, int kSuffix>
constexpr Entry kEntriesOf[] = {
    {kSuffix == 32 ? "trocar_global_f32" : "trocar_global_f64", RunOne<PaperGlobal<Real, RawMemory, false>>,
     false},
    {kSuffix == 32 ? "trocar_coalesced_f32" : "trocar_coalesced_f64",
     RunOne<PaperGlobal<Real, RawMemory, true>>, false},
    {kSuffix == 32 ? "trocar_shared_f32" : "trocar_shared_f64", RunOne<PaperShared<Real, RawMemory, false>>,
     false},
    {kSuffix == 32 ? "trocar_shared_coalesced_f32" : "trocar_shared_coalesced_f64",
     RunOne<PaperShared<Real, RawMemory, true>>, false},
    {kSuffix == 32 ? "trocar_tiled_resident_f32" : "trocar_tiled_resident_f64",
     RunOne<TiledResident<Real, RawMemory>>, true},
    {kSuffix == 32 ? "trocar_tiled_streaming_f32" : "trocar_tiled_streaming_f64",
     RunOne<TiledStreaming<Real, RawMemory>>, true}};

int Launch(CudaFunction function, unsigned blocks, unsigned threads, void** arguments, bool is_cooperative) {
  const auto* entry = reinterpret_cast<const Entry*>(function);
  if (entry->is_cooperative != is_cooperative) return 1;
  if (is_cooperative && blocks > static_cast<unsigned>(ThePlan().blocks * 2))
    return 720;  // too large to run at once
  return entry->run(arguments[0], blocks, threads) ? 0 : 719;
}

}  // namespace

TROCAR_API int cuInit(unsigned) {
  ReadPlan();
  return ThePlan().init;
}
TROCAR_API int cuDriverGetVersion(int* version) {
  *version = ThePlan().version;
  return Count("cuDriverGetVersion");
}
TROCAR_API int cuGetErrorName(int code, const char** name) {
  *name = code == 700   ? "CUDA_ERROR_ILLEGAL_ADDRESS"
          : code == 999 ? "CUDA_ERROR_UNKNOWN"
                        : "CUDA_ERROR_STAND_IN";
  return 0;
}
TROCAR_API int cuDeviceGetCount(int* count) {
  *count = ThePlan().devices;
  return Count("cuDeviceGetCount");
}
TROCAR_API int cuDeviceGet(int* device, int) {
  *device = 0;
  return Count("cuDeviceGet");
}
TROCAR_API int cuDeviceGetName(char* name, int length, int) {
  std::strncpy(name, "Stand-in", static_cast<std::size_t>(length));
  return Count("cuDeviceGetName");
}
TROCAR_API int cuDeviceTotalMem_v2(std::size_t* bytes, int) {
  *bytes = ThePlan().memory;
  return Count("cuDeviceTotalMem");
}
TROCAR_API int cuDeviceGetAttribute(int* value, int attribute, int) {
  switch (attribute) {
    case kMultiprocessorCount:
      *value = 2;
      break;
    case kCapabilityMajor:
      *value = ThePlan().capability / 10;
      break;
    case kCapabilityMinor:
      *value = ThePlan().capability % 10;
      break;
    case kCooperativeLaunch:
      *value = 1;
      break;
    case kMaxSharedBytesPerBlock:
      *value = 232448;
      break;
    default:
      *value = 1;
  }
  return Count("cuDeviceGetAttribute");
}
TROCAR_API int cuDevicePrimaryCtxRetain(CudaContext* context, int) {
  *context = reinterpret_cast<CudaContext>(&ThePlan());
  return Count("cuDevicePrimaryCtxRetain");
}
TROCAR_API int cuDevicePrimaryCtxRelease_v2(int) {
  return Count("cuDevicePrimaryCtxRelease");
}
TROCAR_API int cuCtxSetCurrent(CudaContext) {
  return Count("cuCtxSetCurrent");
}
TROCAR_API int cuModuleLoadData(CudaModule* module, const void* image) {
  *module = reinterpret_cast<CudaModule>(&ThePlan());
  if (image == nullptr || ThePlan().load != 0) return ThePlan().load;
  return Count("cuModuleLoadData");
}
TROCAR_API int cuModuleUnload(CudaModule) {
  return Count("cuModuleUnload");
}
TROCAR_API int cuModuleGetFunction(CudaFunction* function, CudaModule, const char* name) {
  for (const Entry* entries : {kEntriesOf<float, 32>, kEntriesOf<double, 64>}) {
    for (int i = 0; i < 6; ++i) {
      if (std::strcmp(entries[i].name, name) != 0) continue;
      *function = reinterpret_cast<CudaFunction>(const_cast<Entry*>(&entries[i]));
      return Count("cuModuleGetFunction");
    }
  }
  return 500;  // not found
}
TROCAR_API int cuFuncSetAttribute(CudaFunction, int, int) {
  return Count("cuFuncSetAttribute");
}
TROCAR_API int cuOccupancyMaxActiveBlocksPerMultiprocessor(int* blocks, CudaFunction, int, std::size_t) {
  *blocks = ThePlan().blocks;
  return Count("cuOccupancyMaxActiveBlocksPerMultiprocessor");
}
TROCAR_API int cuMemAlloc_v2(CudaAddress* address, std::size_t bytes) {
  Plan& plan = ThePlan();
  if (plan.allocated + bytes > plan.memory) return kCudaOutOfMemory;
  void* const memory = std::malloc(bytes);
  std::memset(memory, 0xff, bytes);
  *address = reinterpret_cast<CudaAddress>(memory);
  plan.allocations[*address] = bytes;
  plan.allocated += bytes;
  return Count("cuMemAlloc");
}
TROCAR_API int cuMemFree_v2(CudaAddress address) {
  Plan& plan = ThePlan();
  const auto found = plan.allocations.find(address);
  if (found == plan.allocations.end()) return 1;
  plan.allocated -= found->second;
  plan.allocations.erase(found);
  std::free(reinterpret_cast<void*>(address));
  return Count("cuMemFree");
}
TROCAR_API int cuMemHostAlloc(void** address, std::size_t bytes, unsigned) {
  *address = std::malloc(bytes);
  return Count("cuMemHostAlloc");
}
TROCAR_API int cuMemFreeHost(void* address) {
  std::free(address);
  return Count("cuMemFreeHost");
}
TROCAR_API int cuMemcpyHtoDAsync_v2(CudaAddress to, const void* from, std::size_t bytes, CudaStream) {
  if (const int code = Count("cuMemcpyHtoDAsync")) return code;
  void* const place = Locate(to, bytes);
  if (place == nullptr) return 1;
  std::memcpy(place, from, bytes);
  return 0;
}
TROCAR_API int cuMemcpyDtoHAsync_v2(void* to, CudaAddress from, std::size_t bytes, CudaStream) {
  if (const int code = Count("cuMemcpyDtoHAsync")) return code;
  const void* const place = Locate(from, bytes);
  if (place == nullptr) return 1;
  std::memcpy(to, place, bytes);
  return 0;
}
TROCAR_API int cuMemsetD8Async(CudaAddress address, unsigned char value, std::size_t bytes, CudaStream) {
  if (const int code = Count("cuMemsetD8Async")) return code;
  void* const place = Locate(address, bytes);
  if (place == nullptr) return 1;
  std::memset(place, value, bytes);
  return 0;
}
TROCAR_API int cuLaunchKernel(CudaFunction function, unsigned blocks, unsigned, unsigned, unsigned threads,
                              unsigned, unsigned, unsigned, CudaStream, void** arguments, void**) {
  if (const int code = Count("cuLaunchKernel")) return code;
  return Launch(function, blocks, threads, arguments, false);
}
TROCAR_API int cuLaunchCooperativeKernel(CudaFunction function, unsigned blocks, unsigned, unsigned,
                                         unsigned threads, unsigned, unsigned, unsigned, CudaStream,
                                         void** arguments) {
  if (const int code = Count("cuLaunchCooperativeKernel")) return code;
  return Launch(function, blocks, threads, arguments, true);
}
TROCAR_API int cuStreamCreate(CudaStream* stream, unsigned) {
  *stream = reinterpret_cast<CudaStream>(&ThePlan());
  return Count("cuStreamCreate");
}
TROCAR_API int cuStreamDestroy_v2(CudaStream) {
  return Count("cuStreamDestroy");
}
TROCAR_API int cuStreamSynchronize(CudaStream) {
  return Count("cuStreamSynchronize");
}
TROCAR_API int cuEventCreate(CudaEvent* event, unsigned) {
  *event = reinterpret_cast<CudaEvent>(&ThePlan());
  return Count("cuEventCreate");
}
TROCAR_API int cuEventDestroy_v2(CudaEvent) {
  return Count("cuEventDestroy");
}
TROCAR_API int cuEventRecord(CudaEvent, CudaStream) {
  return Count("cuEventRecord");
}
TROCAR_API int cuEventElapsedTime(float* milliseconds, CudaEvent, CudaEvent) {
  *milliseconds = 1.0f;
  return Count("cuEventElapsedTime");
}
