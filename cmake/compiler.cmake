# SPDX-License-Identifier: Apache-2.0
# One set of compile options for every target. No fast-math and no contraction: the same inputs must give the same bits.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
# ccache finds the same file in another clone too; a debugger may then show that clone's sources
find_program(TROCAR_CCACHE ccache)
if(TROCAR_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=true ${TROCAR_CCACHE})
endif()

add_library(trocar_compile_options INTERFACE)
# sqrt without errno and comparisons without traps change no result and let loops run in lanes
target_compile_options(trocar_compile_options INTERFACE -ffp-contract=off -fno-math-errno -fno-trapping-math)
# what concerns our own files only: a program that uses the installed libraries chooses its warnings itself
target_compile_options(trocar_compile_options INTERFACE
  "$<BUILD_INTERFACE:-Wall;-Wextra;-Wshadow;-Wnon-virtual-dtor;-Wno-missing-field-initializers>")
# __FILE__ and debug information name files from the repository on: objects do not depend on where a clone lies
target_compile_options(trocar_compile_options INTERFACE $<BUILD_INTERFACE:-ffile-prefix-map=${PROJECT_SOURCE_DIR}=.>)
target_compile_features(trocar_compile_options INTERFACE $<INSTALL_INTERFACE:cxx_std_20>)
# Once the optimiser has inlined it, GCC 12 takes std::string's own copying for an overlap (its bug 105651), by the page.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 14)
  target_compile_options(trocar_compile_options INTERFACE $<BUILD_INTERFACE:-Wno-restrict>)
endif()
# says only that a file is not the first of its unit
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND TROCAR_UNITY)
  target_compile_options(trocar_compile_options INTERFACE $<BUILD_INTERFACE:-Wno-subobject-linkage>)
endif()
# GCC collects its garbage later, which takes a tenth of the time for a tenth more memory
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(trocar_compile_options INTERFACE $<BUILD_INTERFACE:--param=ggc-min-heapsize=300000>)
endif()
if(TROCAR_ENABLE_ASSERTS OR CMAKE_BUILD_TYPE STREQUAL "Debug")
  target_compile_definitions(trocar_compile_options INTERFACE TROCAR_ENABLE_ASSERTS=1)
endif()
if(TROCAR_SANITIZE)
  target_compile_options(trocar_compile_options INTERFACE -fsanitize=${TROCAR_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(trocar_compile_options INTERFACE -fsanitize=${TROCAR_SANITIZE})
endif()
