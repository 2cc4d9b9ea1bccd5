# SPDX-License-Identifier: Apache-2.0
# Plays a recording in the window with real clicks and keys, takes over, and verifies what was recorded from there on.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/recordings)
function(trocar output)
  execute_process(COMMAND ${TROCAR} ${ARGN} OUTPUT_VARIABLE text ERROR_VARIABLE errors RESULT_VARIABLE status TIMEOUT 200)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "trocar ${ARGN} ended with ${status}: ${text} ${errors}")
  endif()
  set(${output} "${text}" PARENT_SCOPE)
endfunction()
trocar(played play novice --task peg_transfer --seconds 20 --seed 3 --record ${FOLDER}/recordings/first.trocar)

file(WRITE ${FOLDER}/run.sh [[
set -u
check=$1 folder=$2
shift 2
"$@" >"$folder/output.txt" 2>&1 &
window=$!
"$check" "$folder"
status=$?
if [ $status -ne 0 ]; then kill $window 2>/dev/null; fi
wait $window
ended=$?
if [ $status -eq 0 ] && [ $ended -ne 0 ]; then echo "the window ended with $ended" >&2; status=1; fi
exit $status
]])
set(ENV{GTK_A11Y} none)
set(ENV{TROCAR_STORE} ${FOLDER}/store.sqlite)
execute_process(
  COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" sh ${FOLDER}/run.sh ${CHECK} ${FOLDER} ${WINDOW}
    --replay ${FOLDER}/recordings/first.trocar --recordings ${FOLDER}/recordings --threads 1
  RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 400)
if(NOT status EQUAL 0)
  file(READ ${FOLDER}/output.txt output)
  message(FATAL_ERROR "the replay window: ${errors}\n${output}")
endif()

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
