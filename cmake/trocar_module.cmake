# SPDX-License-Identifier: Apache-2.0

# How well a file is compiled, by what it does; no bit of a simulation depends on it (tests/bits).
#
#                                              release   relwithassert
#   what is computed in every tick or frame      -O3          -O2       TROCAR_FAST_MODULES
#   what people see, click and type              -O1          -O0       TROCAR_SHOWING_MODULES, windows, commands
#   all else                                     -O3          -O1
#   tests; of fast modules as their modules                   -O0
set(TROCAR_FAST_MODULES
  anatomy base cholecystectomy collision files geometry haptics host images instrument math meshing patient procedures record render rigid rod scene simulation surgery tissue
  tissue_cuda training view)
set(TROCAR_SHOWING_MODULES assessment centre cli doctor editor gui presenter rehearsal report sound store study)

# for the targets of this folder that come after it: tests and the like
function(trocar_compile_quickly)
  add_compile_options($<$<CONFIG:RelWithDebInfo>:-O0>)
endfunction()
# the same for what shows and asks, which does not compute in a release either
function(trocar_compile_for_showing)
  trocar_compile_quickly()
  add_compile_options($<$<CONFIG:Release>:-O1>)
endfunction()

# trocar_module(NAME
#   PUBLIC_HEADERS include/trocar/NAME/a.h ...   each compiles alone (target all_verify_interface_header_sets)
#   SOURCES src/a.cpp ...
#   DEPENDS base math ...                        modules above this one
#   LIBRARIES Eigen3::Eigen ...                  third-party, private
#   TESTS test/a_test.cpp ...                    one executable NAME_tests, each case a ctest
#   FILE_TESTS test/b_test.cpp ...               tests that use modules besides, left out where those are not built
#   TEST_DEPENDS files ...)                      those modules
function(trocar_module name)
  cmake_parse_arguments(arg "" "" "PUBLIC_HEADERS;SOURCES;DEPENDS;LIBRARIES;TESTS;FILE_TESTS;TEST_DEPENDS" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "trocar_module(${name}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  # else its headers would be missing in the middle of a build; a part of a module is a target of its own
  set(absent)
  foreach(needed IN LISTS arg_DEPENDS)
    if(NOT needed IN_LIST TROCAR_MODULES AND NOT TARGET trocar_${needed})
      list(APPEND absent ${needed})
    endif()
  endforeach()
  if(absent)
    message(FATAL_ERROR "trocar_module(${name}): needs ${absent}, which TROCAR_MODULES lacks")
  endif()
  list(TRANSFORM arg_DEPENDS PREPEND trocar_)
  # in a browser the engine's own tests run, and those of what judges in it
  if(EMSCRIPTEN AND NOT CMAKE_CURRENT_SOURCE_DIR MATCHES "/src/(engine/[a-z]+|procedure/(cholecystectomy|procedures))$")
    set(arg_TESTS)
  endif()
  set(missing ${arg_TEST_DEPENDS})
  list(REMOVE_ITEM missing ${TROCAR_MODULES})
  if(missing OR EMSCRIPTEN)
    set(arg_TEST_DEPENDS)
  else()
    list(APPEND arg_TESTS ${arg_FILE_TESTS})
  endif()
  list(TRANSFORM arg_TEST_DEPENDS PREPEND trocar_)
  cmake_language(DEFER CALL trocar_unity_builds)
  if(name IN_LIST TROCAR_SHOWING_MODULES)
    trocar_compile_for_showing()
  endif()
  if(arg_SOURCES)
    add_library(trocar_${name} STATIC ${arg_SOURCES})
    target_include_directories(trocar_${name} PRIVATE src)
    target_sources(trocar_${name} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${arg_PUBLIC_HEADERS})
    target_link_libraries(trocar_${name} PUBLIC ${arg_DEPENDS} trocar_compile_options PRIVATE ${arg_LIBRARIES})
    set_target_properties(trocar_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON VERIFY_INTERFACE_HEADER_SETS ON)
    if(name IN_LIST TROCAR_FAST_MODULES)
      target_compile_options(trocar_${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O2>)
    endif()
  else()
    add_library(trocar_${name} INTERFACE)
    target_sources(trocar_${name} INTERFACE FILE_SET HEADERS BASE_DIRS include FILES ${arg_PUBLIC_HEADERS})
    target_link_libraries(trocar_${name} INTERFACE ${arg_DEPENDS} trocar_compile_options)
    set_target_properties(trocar_${name} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
  endif()
  if(TROCAR_BUILD_TESTS AND arg_TESTS)
    add_executable(${name}_tests ${arg_TESTS})
    target_link_libraries(${name}_tests PRIVATE trocar_${name} ${arg_TEST_DEPENDS} ${arg_LIBRARIES} trocar_test_folders GTest::gmock GTest::gtest_main)
    target_include_directories(${name}_tests PRIVATE src)
    if(NOT name IN_LIST TROCAR_FAST_MODULES)
      target_compile_options(${name}_tests PRIVATE $<$<CONFIG:RelWithDebInfo>:-O0>)
    endif()
    trocar_discover_tests(${name}_tests ${name})
  endif()
endfunction()
