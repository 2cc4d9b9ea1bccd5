// SPDX-License-Identifier: Apache-2.0
/// \file built_in_code.cpp  The GPU code that this build carries, or none.
#include "driver.h"

#if TROCAR_HAS_GPU_CODE
// the file that cmake/gpu_code.cmake makes, byte for byte
asm(R"(
  .pushsection .rodata
  .balign 64
  .hidden trocar_gpu_code
  .global trocar_gpu_code
trocar_gpu_code:
  .incbin ")" TROCAR_GPU_CODE_FILE R"("
  .hidden trocar_gpu_code_end
  .global trocar_gpu_code_end
trocar_gpu_code_end:
  .byte 0
  .popsection
)");
extern "C" const unsigned char trocar_gpu_code[], trocar_gpu_code_end[];
#endif

namespace trocar::tissue_cuda {

DriverSource BuiltInSource() {
  DriverSource source;
#if TROCAR_HAS_GPU_CODE
  source.code = {trocar_gpu_code, static_cast<std::size_t>(trocar_gpu_code_end - trocar_gpu_code)};
  source.code_version = TROCAR_CUDA_VERSION;
#endif
  return source;
}

}  // namespace trocar::tissue_cuda
