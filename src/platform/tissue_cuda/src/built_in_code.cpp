// SPDX-License-Identifier: Apache-2.0
/// \file built_in_code.cpp  The GPU code that this build carries, or none.
#include "driver.h"

#if TROCAR_HAS_GPU_CODE
// the file that cmake/gpu_code.cmake makes, byte for byte
asm(R"(
  .pushsection .rodata
  .balign 64
  .hidden kTrocarGpuCode
  .global kTrocarGpuCode
kTrocarGpuCode:
  .incbin ")" TROCAR_GPU_CODE_FILE R"("
  .hidden kTrocarGpuCodeEnd
  .global kTrocarGpuCodeEnd
kTrocarGpuCodeEnd:
  .byte 0
  .popsection
)");
extern "C" const unsigned char kTrocarGpuCode[], kTrocarGpuCodeEnd[];
#endif

namespace trocar::tissue_cuda {

DriverSource BuiltInSource() {
  DriverSource source;
#if TROCAR_HAS_GPU_CODE
  source.code = {kTrocarGpuCode, static_cast<std::size_t>(kTrocarGpuCodeEnd - kTrocarGpuCode)};
  source.code_version = TROCAR_CUDA_VERSION;
#endif
  return source;
}

}  // namespace trocar::tissue_cuda
