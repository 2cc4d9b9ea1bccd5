# SPDX-License-Identifier: Apache-2.0
# GPU code, where there is a CUDA compiler. nvcc turns one .cu file into a fat binary, which the program carries as bytes
# and hands to the driver; nothing is linked against CUDA, so that CMake's CUDA language, which wants a host compiler of
# nvcc's choosing, is not needed and a build without nvcc differs in these bytes alone.
option(TROCAR_CUDA "Compile GPU code where nvcc is found" ON)
set(TROCAR_CUDA_ARCHITECTURES "80;86;89;90" CACHE STRING "GPUs to compile for; others get their code from the driver")
# what the driver compiles for any GPU that is not listed; also the oldest that runs
set(TROCAR_CUDA_OLDEST_ARCHITECTURE 75)

find_program(TROCAR_NVCC nvcc HINTS $ENV{CUDA_HOME}/bin $ENV{CUDA_PATH}/bin /usr/local/cuda/bin)

# trocar_gpu_code(kernels.cu HEADERS ...): compiles it and tells src/built_in_code.cpp of it, or that there is none
function(trocar_gpu_code source)
  cmake_parse_arguments(arg "" "" "HEADERS" ${ARGN})
  set(version 0)
  if(TROCAR_CUDA AND TROCAR_NVCC)
    execute_process(COMMAND ${TROCAR_NVCC} --version OUTPUT_VARIABLE text ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed AND text MATCHES "release ([0-9]+)\\.([0-9]+)")
      math(EXPR version "1000 * ${CMAKE_MATCH_1} + 10 * ${CMAKE_MATCH_2}")
    endif()
  endif()
  if(version LESS 11080)
    set(TROCAR_GPU_CODE_VERSION 0 CACHE INTERNAL "CUDA version of the GPU code, or 0")
    message(STATUS "GPU code: none (no nvcc of CUDA 11.8 or newer); tissue is computed on the processor")
    set_property(SOURCE src/built_in_code.cpp APPEND PROPERTY COMPILE_DEFINITIONS TROCAR_HAS_GPU_CODE=0)
    return()
  endif()
  message(STATUS "GPU code: ${TROCAR_NVCC}, for sm_${TROCAR_CUDA_ARCHITECTURES} and compute_${TROCAR_CUDA_OLDEST_ARCHITECTURE}")
  set(TROCAR_GPU_CODE_VERSION ${version} CACHE INTERNAL "CUDA version of the GPU code, or 0")
  set(fat_binary ${CMAKE_CURRENT_BINARY_DIR}/kernels.fatbin)
  set(gencodes -gencode arch=compute_${TROCAR_CUDA_OLDEST_ARCHITECTURE},code=compute_${TROCAR_CUDA_OLDEST_ARCHITECTURE})
  foreach(architecture IN LISTS TROCAR_CUDA_ARCHITECTURES)
    list(APPEND gencodes -gencode arch=compute_${architecture},code=sm_${architecture})
  endforeach()
  # no fused multiply-add: the host executor's bits are the GPU's bits
  add_custom_command(OUTPUT ${fat_binary}
    COMMAND ${TROCAR_NVCC} -ccbin ${CMAKE_CXX_COMPILER} -allow-unsupported-compiler -std=c++17 -O3 -fmad=false
      --fatbin -o ${fat_binary} ${gencodes} ${CMAKE_CURRENT_SOURCE_DIR}/${source}
    DEPENDS ${source} ${arg_HEADERS}
    COMMENT "GPU code" VERBATIM COMMAND_EXPAND_LISTS)
  set_property(SOURCE src/built_in_code.cpp APPEND PROPERTY OBJECT_DEPENDS ${fat_binary})
  set_property(SOURCE src/built_in_code.cpp APPEND PROPERTY COMPILE_DEFINITIONS
    TROCAR_HAS_GPU_CODE=1 TROCAR_CUDA_VERSION=${version} TROCAR_GPU_CODE_FILE="${fat_binary}")
endfunction()
