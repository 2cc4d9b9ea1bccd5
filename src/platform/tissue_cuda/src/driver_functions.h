// SPDX-License-Identifier: Apache-2.0
/// \file driver_functions.h  The part of CUDA's driver interface that is used, declared by us, so that
/// building needs no CUDA headers. Names, types and numbers are those of the driver's stable binary
/// interface; where the headers are there, a test compares (test/driver_interface_test.cpp).
#pragma once

#include <cstddef>

namespace trocar::tissue_cuda {

using CudaCode = int;  // CUresult
using CudaDevice = int;
using CudaAddress = unsigned long long;  // CUdeviceptr
using CudaContext = struct CUctx_st*;
using CudaModule = struct CUmod_st*;
using CudaFunction = struct CUfunc_st*;
using CudaStream = struct CUstream_st*;
using CudaEvent = struct CUevent_st*;

inline constexpr CudaCode kCudaSuccess = 0, kCudaOutOfMemory = 2, kCudaNoDevice = 100,
                          kCudaInvalidImage = 200, kCudaNoBinaryForGpu = 209, kCudaInvalidPtx = 218,
                          kCudaUnsupportedPtx = 222, kCudaDriverMismatch = 803;

/// Questions for cuDeviceGetAttribute.
enum DeviceAttribute : int {
  kMultiprocessorCount = 16,
  kMemoryClockRate = 36,  // [kHz]
  kMemoryBusWidth = 37,   // [bit]
  kCapabilityMajor = 75,
  kCapabilityMinor = 76,
  kCooperativeLaunch = 95,
  kMaxSharedBytesPerBlock = 97
};
/// For cuFuncSetAttribute.
inline constexpr int kMaxDynamicSharedBytes = 8;

/// Every function as X(name of ours, symbol, arguments).
#define TROCAR_DRIVER_FUNCTIONS(X)                                                                           \
  X(init, cuInit, (unsigned flags))                                                                          \
  X(get_version, cuDriverGetVersion, (int* version))                                                         \
  X(get_error_name, cuGetErrorName, (CudaCode code, const char** name))                                      \
  X(get_device_count, cuDeviceGetCount, (int* count))                                                        \
  X(get_device, cuDeviceGet, (CudaDevice * device, int ordinal))                                             \
  X(get_device_name, cuDeviceGetName, (char* name, int length, CudaDevice device))                           \
  X(get_device_memory, cuDeviceTotalMem_v2, (std::size_t * bytes, CudaDevice device))                        \
  X(get_device_attribute, cuDeviceGetAttribute, (int* value, int attribute, CudaDevice device))              \
  X(retain_context, cuDevicePrimaryCtxRetain, (CudaContext * context, CudaDevice device))                    \
  X(release_context, cuDevicePrimaryCtxRelease_v2, (CudaDevice device))                                      \
  X(set_context, cuCtxSetCurrent, (CudaContext context))                                                     \
  X(load_module, cuModuleLoadData, (CudaModule * module, const void* image))                                 \
  X(unload_module, cuModuleUnload, (CudaModule module))                                                      \
  X(get_function, cuModuleGetFunction, (CudaFunction * function, CudaModule module, const char* name))       \
  X(set_function_attribute, cuFuncSetAttribute, (CudaFunction function, int attribute, int value))           \
  X(count_active_blocks, cuOccupancyMaxActiveBlocksPerMultiprocessor,                                        \
    (int* blocks, CudaFunction function, int threads, std::size_t shared_bytes))                             \
  X(allocate, cuMemAlloc_v2, (CudaAddress * address, std::size_t bytes))                                     \
  X(free, cuMemFree_v2, (CudaAddress address))                                                               \
  X(allocate_host, cuMemHostAlloc, (void** address, std::size_t bytes, unsigned flags))                      \
  X(free_host, cuMemFreeHost, (void* address))                                                               \
  X(copy_to, cuMemcpyHtoDAsync_v2, (CudaAddress to, const void* from, std::size_t bytes, CudaStream stream)) \
  X(copy_from, cuMemcpyDtoHAsync_v2, (void* to, CudaAddress from, std::size_t bytes, CudaStream stream))     \
  X(copy_within, cuMemcpyDtoDAsync_v2,                                                                       \
    (CudaAddress to, CudaAddress from, std::size_t bytes, CudaStream stream))                                \
  X(fill_bytes, cuMemsetD8Async,                                                                             \
    (CudaAddress address, unsigned char value, std::size_t bytes, CudaStream stream))                        \
  X(launch, cuLaunchKernel,                                                                                  \
    (CudaFunction function, unsigned blocks_x, unsigned blocks_y, unsigned blocks_z, unsigned threads_x,     \
     unsigned threads_y, unsigned threads_z, unsigned shared_bytes, CudaStream stream, void** arguments,     \
     void** extra))                                                                                          \
  X(launch_cooperative, cuLaunchCooperativeKernel,                                                           \
    (CudaFunction function, unsigned blocks_x, unsigned blocks_y, unsigned blocks_z, unsigned threads_x,     \
     unsigned threads_y, unsigned threads_z, unsigned shared_bytes, CudaStream stream, void** arguments))    \
  X(create_stream, cuStreamCreate, (CudaStream * stream, unsigned flags))                                    \
  X(destroy_stream, cuStreamDestroy_v2, (CudaStream stream))                                                 \
  X(synchronize, cuStreamSynchronize, (CudaStream stream))                                                   \
  X(create_event, cuEventCreate, (CudaEvent * event, unsigned flags))                                        \
  X(destroy_event, cuEventDestroy_v2, (CudaEvent event))                                                     \
  X(record_event, cuEventRecord, (CudaEvent event, CudaStream stream))                                       \
  X(elapsed, cuEventElapsedTime, (float* milliseconds, CudaEvent start, CudaEvent end))

/// Addresses of the functions in a loaded driver.
struct DriverFunctions {
#define TROCAR_DECLARE(name, symbol, arguments) CudaCode(*name) arguments = nullptr;
  TROCAR_DRIVER_FUNCTIONS(TROCAR_DECLARE)
#undef TROCAR_DECLARE
};

}  // namespace trocar::tissue_cuda
