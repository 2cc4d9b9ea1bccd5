# SPDX-License-Identifier: Apache-2.0
# Plays a recording in the window with real clicks and keys, takes over, and verifies what was recorded from there on.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/recordings)
include(${CMAKE_CURRENT_LIST_DIR}/window_run.cmake)
trocar(played play novice --task peg_transfer --seconds 20 --seed 3 --record ${FOLDER}/recordings/first.trocar)

set(ENV{TROCAR_STORE} ${FOLDER}/store.sqlite)
use_window(--replay ${FOLDER}/recordings/first.trocar --recordings ${FOLDER}/recordings --threads 1)

# whoever took over has a recording of his own, which says where it comes from and is verified
file(GLOB recordings ${FOLDER}/recordings/*_peg_transfer.trocar)
list(LENGTH recordings count)
if(NOT count EQUAL 1)
  message(FATAL_ERROR "one attempt was taken over, and there are ${count} recordings of it")
endif()
trocar(info record info ${recordings} --json)
string(JSON from GET "${info}" branched from)
string(JSON tick GET "${info}" branched tick)
string(JSON first GET "${info}" first_tick)
string(JSON ticks GET "${info}" ticks)
if(NOT from STREQUAL "first.trocar" OR NOT tick EQUAL first OR tick LESS 300 OR ticks LESS 120)
  message(FATAL_ERROR "the recording does not say where it comes from: ${info}")
endif()
trocar(verified replay ${recordings} --verify)
if(NOT verified MATCHES "^VERIFIED")
  message(FATAL_ERROR "what was taken over is not verified: ${verified}")
endif()
