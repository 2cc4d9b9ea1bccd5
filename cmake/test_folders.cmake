# SPDX-License-Identifier: Apache-2.0
# trocar_test_folders: what every test links to learn where the repository lies (tests/include/trocar_test/folders.h)
if(TROCAR_BUILD_TESTS)
  add_library(trocar_test_folders STATIC tests/folders.cpp)
  set_source_files_properties(tests/folders.cpp PROPERTIES
    COMPILE_DEFINITIONS TROCAR_TEST_SOURCE_FOLDER="${PROJECT_SOURCE_DIR}")
  target_include_directories(trocar_test_folders PUBLIC tests/include)
  target_compile_options(trocar_test_folders INTERFACE "SHELL:-include trocar_test/folders.h")
  target_link_libraries(trocar_test_folders PUBLIC trocar_compile_options)
endif()
