// SPDX-License-Identifier: Apache-2.0
/// \file driver_interface_test.cpp  What driver_functions.h declares, against NVIDIA's own header where it is
/// installed.
#include <gtest/gtest.h>

#include <cstring>
#include <type_traits>

#include "driver_functions.h"

#if __has_include(<cuda.h>)
#include <cuda.h>

namespace trocar::tissue_cuda {
namespace {

// Enumerations travel as int, handles as pointers: the same registers, so sizes and ranks decide.
template <typename Ours, typename Theirs>
constexpr bool kIsAlike =
    sizeof(Ours) == sizeof(Theirs) && std::is_pointer_v<Ours> ==
                                          std::is_pointer_v<Theirs>&& std::is_floating_point_v<Ours> ==
                                          std::is_floating_point_v<Theirs>;

template <typename Ours, typename Theirs>
struct SameCall : std::false_type {};
template <typename... Ours, typename... Theirs>
struct SameCall<CudaCode (*)(Ours...), CUresult (*)(Theirs...)> {
  static constexpr bool Compare() {
    if constexpr (sizeof...(Ours) != sizeof...(Theirs)) {
      return false;
    } else {
      return (kIsAlike<Ours, Theirs> && ...);
    }
  }
  static constexpr bool value = Compare();
};

TEST(DriverInterface, IsThatOfTheInstalledHeaders) {
#define TROCAR_COMPARE(name, symbol, arguments) \
  EXPECT_TRUE((SameCall<decltype(DriverFunctions::name), decltype(&::symbol)>::value)) << #symbol;
  TROCAR_DRIVER_FUNCTIONS(TROCAR_COMPARE)
#undef TROCAR_COMPARE
}

TEST(DriverInterface, NumbersAreThoseOfTheInstalledHeaders) {
  EXPECT_EQ(kCudaOutOfMemory, CUDA_ERROR_OUT_OF_MEMORY);
  EXPECT_EQ(kCudaNoDevice, CUDA_ERROR_NO_DEVICE);
  EXPECT_EQ(kCudaInvalidImage, CUDA_ERROR_INVALID_IMAGE);
  EXPECT_EQ(kCudaNoBinaryForGpu, CUDA_ERROR_NO_BINARY_FOR_GPU);
  EXPECT_EQ(kCudaInvalidPtx, CUDA_ERROR_INVALID_PTX);
  EXPECT_EQ(kCudaUnsupportedPtx, CUDA_ERROR_UNSUPPORTED_PTX_VERSION);
  EXPECT_EQ(kCudaDriverMismatch, CUDA_ERROR_SYSTEM_DRIVER_MISMATCH);
  EXPECT_EQ(kMultiprocessorCount, CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT);
  EXPECT_EQ(kMemoryClockRate, CU_DEVICE_ATTRIBUTE_MEMORY_CLOCK_RATE);
  EXPECT_EQ(kMemoryBusWidth, CU_DEVICE_ATTRIBUTE_GLOBAL_MEMORY_BUS_WIDTH);
  EXPECT_EQ(kCapabilityMajor, CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR);
  EXPECT_EQ(kCapabilityMinor, CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MINOR);
  EXPECT_EQ(kCooperativeLaunch, CU_DEVICE_ATTRIBUTE_COOPERATIVE_LAUNCH);
  EXPECT_EQ(kMaxSharedBytesPerBlock, CU_DEVICE_ATTRIBUTE_MAX_SHARED_MEMORY_PER_BLOCK_OPTIN);
  EXPECT_EQ(kMaxDynamicSharedBytes, CU_FUNC_ATTRIBUTE_MAX_DYNAMIC_SHARED_SIZE_BYTES);
}

}  // namespace
}  // namespace trocar::tissue_cuda
#else
TEST(DriverInterface, IsThatOfTheInstalledHeaders) {
  GTEST_SKIP() << "cuda.h is not installed; it comes with nvcc";
}
#endif
