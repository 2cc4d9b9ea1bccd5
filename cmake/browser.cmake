# SPDX-License-Identifier: Apache-2.0
# WebAssembly, by emscripten: nothing of the system's libraries is there. Headers alone are taken from the system, Bullet is compiled
# from its source (tools/get-bullet-source), GoogleTest from its package's.
set(TROCAR_BULLET_SOURCE "" CACHE PATH "Bullet's source, for builds that cannot link the system's: tools/get-bullet-source FOLDER, then FOLDER/bullet")
option(TROCAR_WASM_VECTORS "Use WebAssembly's vectors (SIMD128)" ON)

add_link_options(-sALLOW_MEMORY_GROWTH -sTOTAL_STACK=4194304)
if(TROCAR_WASM_VECTORS)
  # clang 14 joins scalar sums of two lambdas into vectors wrongly here (wall.cpp: stiffness 20 % off, found by surgery_tests):
  # only what is written as vectors becomes vectors
  add_compile_options(-msimd128 -fno-slp-vectorize)
endif()
# the standard library of Debian 12's emscripten lacks what is in here
add_compile_options("SHELL:-isystem ${PROJECT_SOURCE_DIR}/cmake/older_libcxx")

# headers alone, without the rest of /usr/include, which is another system's
set(headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(folder nlohmann spdlog fmt)
  if(EXISTS /usr/include/${folder} AND NOT EXISTS ${headers}/${folder})
    file(CREATE_LINK /usr/include/${folder} ${headers}/${folder} SYMBOLIC)
  endif()
endforeach()
add_library(trocar_json INTERFACE)
target_include_directories(trocar_json SYSTEM INTERFACE ${headers})
add_library(nlohmann_json::nlohmann_json ALIAS trocar_json)
add_library(trocar_spdlog INTERFACE)
target_include_directories(trocar_spdlog SYSTEM INTERFACE ${headers})
target_compile_definitions(trocar_spdlog INTERFACE SPDLOG_FMT_EXTERNAL FMT_HEADER_ONLY)
set(TROCAR_SPDLOG trocar_spdlog)
add_library(trocar_no_threads INTERFACE)
add_library(Threads::Threads ALIAS trocar_no_threads)

if("rigid" IN_LIST TROCAR_MODULES)
  if(NOT EXISTS ${TROCAR_BULLET_SOURCE}/src/btBulletDynamicsAll.cpp)
    message(FATAL_ERROR "TROCAR_BULLET_SOURCE names no source of Bullet: run tools/get-bullet-source FOLDER and give -DTROCAR_BULLET_SOURCE=FOLDER/bullet")
  endif()
  add_library(trocar_bullet STATIC ${TROCAR_BULLET_SOURCE}/src/btLinearMathAll.cpp ${TROCAR_BULLET_SOURCE}/src/btBulletCollisionAll.cpp
    ${TROCAR_BULLET_SOURCE}/src/btBulletDynamicsAll.cpp)
  target_include_directories(trocar_bullet SYSTEM PUBLIC ${TROCAR_BULLET_SOURCE}/src)
  # as Debian's bullet-float64
  target_compile_definitions(trocar_bullet PUBLIC BT_USE_DOUBLE_PRECISION)
  target_compile_options(trocar_bullet PRIVATE -w -O2 -ffp-contract=off)
  add_library(PkgConfig::BULLET ALIAS trocar_bullet)
endif()

if(TROCAR_BUILD_TESTS)
  set(folder /usr/src/googletest)
  if(NOT EXISTS ${folder}/googletest/src/gtest-all.cc)
    message(FATAL_ERROR "there is no GoogleTest in ${folder}: install googletest, or give -DTROCAR_BUILD_TESTS=OFF")
  endif()
  add_library(trocar_gtest STATIC ${folder}/googletest/src/gtest-all.cc ${folder}/googlemock/src/gmock-all.cc)
  target_include_directories(trocar_gtest SYSTEM PUBLIC ${folder}/googletest/include ${folder}/googlemock/include)
  target_include_directories(trocar_gtest PRIVATE ${folder}/googletest ${folder}/googlemock)
  add_library(trocar_gtest_main STATIC ${folder}/googletest/src/gtest_main.cc)
  target_link_libraries(trocar_gtest_main PUBLIC trocar_gtest)
  add_library(GTest::gmock ALIAS trocar_gtest)
  add_library(GTest::gtest_main ALIAS trocar_gtest_main)
  # tests read files of this tree, and say by their exit status what they found
  # one file each: the node of today takes the name of a second one for an address
  add_link_options(-sNODERAWFS -sEXIT_RUNTIME -sENVIRONMENT=node -sSINGLE_FILE)
  include(GoogleTest)
endif()
