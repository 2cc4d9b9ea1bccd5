// SPDX-License-Identifier: Apache-2.0
/// \file stand_in_cuda.cpp  A libcuda.so.1 for tests: the GPU made of the processor (host_driver.h), which
/// goes wrong as the environment variable TROCAR_STAND_IN_CUDA says when cuInit is called:
///   init=CODE load=CODE               what cuInit and cuModuleLoadData answer
///   version=N devices=N capability=N  what there is
///   multiprocessors=N memory=BYTES    how much of it
///   spoil=N                           one bit of the Nth copy from the GPU is wrong
///   fail=FUNCTION:N:CODE              the Nth call of a function fails, and every call after it, as on a
///   real GPU
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <string>

#include "host_driver.h"

namespace {

using namespace trocar::tissue_cuda;  // NOLINT: one file, one purpose

/// What goes wrong, and what was called.
struct Plan {
  std::map<std::string, std::string> words;
  std::string fail_function;
  int fail_call = 0, fail_code = 0;
  std::map<std::string, int> calls;
  int sticky = 0;
  std::size_t allocated = 0;

  long Number(const char* word, long otherwise) const {
    const auto found = words.find(word);
    return found == words.end() ? otherwise : std::stol(found->second);
  }
};

Plan& ThePlan() {
  static Plan plan;
  return plan;
}

const DriverFunctions& Host() {
  static const DriverFunctions host = HostDriver();
  return host;
}

void ReadPlan() {
  Plan plan;
  const char* text = std::getenv("TROCAR_STAND_IN_CUDA");
  std::istringstream words(text != nullptr ? text : "");
  for (std::string word; words >> word;) {
    const auto equals = word.find('=');
    plan.words[word.substr(0, equals)] = word.substr(equals + 1);
  }
  const std::string fail = plan.words["fail"];
  if (!fail.empty()) {
    const auto first = fail.find(':'), second = fail.find(':', first + 1);
    plan.fail_function = fail.substr(0, first);
    plan.fail_call = std::stoi(fail.substr(first + 1, second - first - 1));
    plan.fail_code = std::stoi(fail.substr(second + 1));
  }
  ThePlan() = std::move(plan);
}

/// Counts a call; its code if it is to fail.
CudaCode Count(const char* function) {
  Plan& plan = ThePlan();
  if (plan.sticky != 0) return plan.sticky;
  if (++plan.calls[function] == plan.fail_call && plan.fail_function == function)
    plan.sticky = plan.fail_code;
  return plan.sticky;
}

/// Answers in place of the host driver.
CudaCode Answer(const char* function, int* value, long answer) {
  *value = static_cast<int>(answer);
  return Count(function);
}

}  // namespace

#define TROCAR_API extern "C" __attribute__((visibility("default"))) CudaCode
// passes a call on, unless it is to fail
#define TROCAR_PASS(name, symbol, arguments, values)       \
  TROCAR_API symbol arguments {                            \
    if (const CudaCode code = Count(#symbol)) return code; \
    return Host().name values;                             \
  }

/// Memory goes back even when the call is to fail: nothing else would free it here, as a broken driver's process does.
#define TROCAR_GIVE_BACK(name, symbol, arguments, values)  \
  TROCAR_API symbol arguments {                            \
    const CudaCode done = Host().name values;              \
    if (const CudaCode code = Count(#symbol)) return code; \
    return done;                                           \
  }

TROCAR_API cuInit(unsigned) {
  ReadPlan();
  return static_cast<CudaCode>(ThePlan().Number("init", 0));
}
TROCAR_API cuGetErrorName(CudaCode code, const char** name) {
  *name = code == 700 ? "CUDA_ERROR_ILLEGAL_ADDRESS" : "CUDA_ERROR_STAND_IN";
  return 0;
}
TROCAR_API cuDriverGetVersion(int* version) {
  return Answer("cuDriverGetVersion", version, ThePlan().Number("version", 13000));
}
TROCAR_API cuDeviceGetCount(int* count) {
  return Answer("cuDeviceGetCount", count, ThePlan().Number("devices", 1));
}
TROCAR_API cuDeviceGetName(char* name, int length, CudaDevice) {
  std::strncpy(name, "Stand-in", static_cast<std::size_t>(length));
  return Count("cuDeviceGetName");
}
TROCAR_API cuDeviceTotalMem_v2(std::size_t* bytes, CudaDevice) {
  *bytes = static_cast<std::size_t>(ThePlan().Number("memory", 1 << 30));
  return Count("cuDeviceTotalMem_v2");
}
TROCAR_API cuDeviceGetAttribute(int* value, int attribute, CudaDevice device) {
  if (const CudaCode code = Count("cuDeviceGetAttribute")) return code;
  const long capability = ThePlan().Number("capability", 90);
  if (attribute == kMultiprocessorCount) return Answer("", value, ThePlan().Number("multiprocessors", 64));
  if (attribute == kCapabilityMajor) return Answer("", value, capability / 10);
  if (attribute == kCapabilityMinor) return Answer("", value, capability % 10);
  return Host().get_device_attribute(value, attribute, device);
}
TROCAR_API cuModuleLoadData(CudaModule* module, const void* image) {
  if (const CudaCode code = Count("cuModuleLoadData")) return code;
  if (const long code = ThePlan().Number("load", 0)) return static_cast<CudaCode>(code);
  return Host().load_module(module, image);
}
TROCAR_API cuMemAlloc_v2(CudaAddress* address, std::size_t bytes) {
  if (const CudaCode code = Count("cuMemAlloc_v2")) return code;
  ThePlan().allocated += bytes;
  if (ThePlan().allocated > static_cast<std::size_t>(ThePlan().Number("memory", 1 << 30)))
    return kCudaOutOfMemory;
  return Host().allocate(address, bytes);
}
TROCAR_API cuMemcpyDtoHAsync_v2(void* to, CudaAddress from, std::size_t bytes, CudaStream stream) {
  if (const CudaCode code = Count("cuMemcpyDtoHAsync_v2")) return code;
  const CudaCode code = Host().copy_from(to, from, bytes, stream);
  if (ThePlan().calls["cuMemcpyDtoHAsync_v2"] == ThePlan().Number("spoil", 0))
    *static_cast<unsigned char*>(to) ^= 1;
  return code;
}
TROCAR_API cuEventElapsedTime(float* milliseconds, CudaEvent, CudaEvent) {
  *milliseconds = 1.0f;
  return Count("cuEventElapsedTime");
}
TROCAR_PASS(get_device, cuDeviceGet, (CudaDevice * device, int ordinal), (device, ordinal))
TROCAR_PASS(retain_context, cuDevicePrimaryCtxRetain, (CudaContext * context, CudaDevice device),
            (context, device))
TROCAR_PASS(release_context, cuDevicePrimaryCtxRelease_v2, (CudaDevice device), (device))
TROCAR_PASS(set_context, cuCtxSetCurrent, (CudaContext context), (context))
TROCAR_PASS(unload_module, cuModuleUnload, (CudaModule module), (module))
TROCAR_PASS(get_function, cuModuleGetFunction, (CudaFunction * function, CudaModule module, const char* name),
            (function, module, name))
TROCAR_PASS(set_function_attribute, cuFuncSetAttribute, (CudaFunction function, int attribute, int value),
            (function, attribute, value))
TROCAR_PASS(count_active_blocks, cuOccupancyMaxActiveBlocksPerMultiprocessor,
            (int* blocks, CudaFunction function, int threads, std::size_t bytes),
            (blocks, function, threads, bytes))
TROCAR_GIVE_BACK(free, cuMemFree_v2, (CudaAddress address), (address))
TROCAR_PASS(allocate_host, cuMemHostAlloc, (void** address, std::size_t bytes, unsigned flags),
            (address, bytes, flags))
TROCAR_GIVE_BACK(free_host, cuMemFreeHost, (void* address), (address))
TROCAR_PASS(copy_to, cuMemcpyHtoDAsync_v2,
            (CudaAddress to, const void* from, std::size_t bytes, CudaStream stream),
            (to, from, bytes, stream))
TROCAR_PASS(copy_within, cuMemcpyDtoDAsync_v2,
            (CudaAddress to, CudaAddress from, std::size_t bytes, CudaStream stream),
            (to, from, bytes, stream))
TROCAR_PASS(fill_bytes, cuMemsetD8Async,
            (CudaAddress address, unsigned char value, std::size_t bytes, CudaStream stream),
            (address, value, bytes, stream))
TROCAR_PASS(launch, cuLaunchKernel,
            (CudaFunction function, unsigned x, unsigned y, unsigned z, unsigned threads_x,
             unsigned threads_y, unsigned threads_z, unsigned bytes, CudaStream stream, void** arguments,
             void** extra),
            (function, x, y, z, threads_x, threads_y, threads_z, bytes, stream, arguments, extra))
TROCAR_PASS(launch_cooperative, cuLaunchCooperativeKernel,
            (CudaFunction function, unsigned x, unsigned y, unsigned z, unsigned threads_x,
             unsigned threads_y, unsigned threads_z, unsigned bytes, CudaStream stream, void** arguments),
            (function, x, y, z, threads_x, threads_y, threads_z, bytes, stream, arguments))
TROCAR_PASS(create_stream, cuStreamCreate, (CudaStream * stream, unsigned flags), (stream, flags))
TROCAR_PASS(destroy_stream, cuStreamDestroy_v2, (CudaStream stream), (stream))
TROCAR_PASS(synchronize, cuStreamSynchronize, (CudaStream stream), (stream))
TROCAR_PASS(create_event, cuEventCreate, (CudaEvent * event, unsigned flags), (event, flags))
TROCAR_PASS(destroy_event, cuEventDestroy_v2, (CudaEvent event), (event))
TROCAR_PASS(record_event, cuEventRecord, (CudaEvent event, CudaStream stream), (event, stream))
