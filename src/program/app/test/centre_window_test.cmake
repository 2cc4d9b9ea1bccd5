# SPDX-License-Identifier: Apache-2.0
# Plays a little in the window with real keys, finishes, and looks at the pages; the store has the attempt, of the right person.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/recordings)
include(${CMAKE_CURRENT_LIST_DIR}/window_run.cmake)
use_window(--task instrument_navigation --level easy --recordings ${FOLDER}/recordings --store ${FOLDER}/store.sqlite
  --trainee "Anna Berg" --threads 1)

trocar(text store attempts --store ${FOLDER}/store.sqlite --json)
string(JSON count LENGTH "${text}" attempts)
if(NOT count EQUAL 2)
  message(FATAL_ERROR "an attempt and one at a step were made, and the store has ${count}: ${text}")
endif()
math(EXPR oldest "${count} - 1")
string(JSON task GET "${text}" attempts ${oldest} task)
string(JSON trainee GET "${text}" attempts ${oldest} trainee)
string(JSON completed GET "${text}" attempts ${oldest} completed)
if(NOT task STREQUAL "instrument_navigation" OR NOT trainee MATCHES "^T-......$" OR completed)
  message(FATAL_ERROR "the attempt is another: ${text}")
endif()
# the name is in the names' file and nowhere else
execute_process(COMMAND grep -rl "Anna Berg" ${FOLDER} OUTPUT_VARIABLE named)
if(NOT named MATCHES "^[^\n]*names.json\n$")
  message(FATAL_ERROR "the name lies in ${named}")
endif()
