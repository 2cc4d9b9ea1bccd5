# SPDX-License-Identifier: Apache-2.0
# Lanes of tests. Each test has the label of one: fast (./test runs them), slow (minutes of processor time), golden (state
# hashes), whole (a whole operation, tens of minutes). The test every_test_has_a_lane watches over it.
set(TROCAR_LANES fast slow golden whole)

# trocar_discover_tests(TARGET LABEL): each case of a GoogleTest program becomes a ctest with this label and its lane.
# The lane stands in the suite's name: `OperationSlow.Name`, `OperationWhole.Name`; all others are fast.
function(trocar_discover_tests target label)
  set(filter_fast "-*Slow.*:*Slow/*:*Whole.*:*Whole/*")
  set(filter_slow "*Slow.*:*Slow/*")
  set(filter_whole "*Whole.*:*Whole/*")
  set(seconds_fast 300)
  set(seconds_slow 7200)
  set(seconds_whole 14400)
  # gtest_discover_tests takes no property that is a list: the labels are set in a file that ctest reads after its own
  set(text "# labels of ${target}, by cmake/lanes.cmake\n")
  foreach(lane fast slow whole)
    gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST TEST_FILTER ${filter_${lane}} TEST_LIST ${target}_${lane}
      PROPERTIES TIMEOUT ${seconds_${lane}})
    string(APPEND text "foreach(test IN LISTS ${target}_${lane})\n"
      "  set_tests_properties(\"\${test}\" PROPERTIES LABELS \"${label};${lane}\")\nendforeach()\n")
  endforeach()
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${target}_lanes.cmake CONTENT "${text}" @ONLY)
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${CMAKE_CURRENT_BINARY_DIR}/${target}_lanes.cmake)
endfunction()
