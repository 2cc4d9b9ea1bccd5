# SPDX-License-Identifier: Apache-2.0
# Opens windows on a virtual display, as for a person, and looks how long the tool-tips of their buttons stay. A window with
# GTK's own tool-tips is the control: there one stays open.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
file(WRITE ${FOLDER}/run.sh [[
set -u
check=$1 output=$2
shift 2
"$@" >"$output" 2>&1 &
window=$!
"$check" "$(dirname "$output")"
status=$?
kill $window 2>/dev/null
wait $window 2>/dev/null
exit $status
]])
set(ENV{GTK_A11Y} none)
set(ENV{TROCAR_STORE} ${FOLDER}/store.sqlite)
function(look name)
  execute_process(
    COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" sh ${FOLDER}/run.sh ${CHECK} ${FOLDER}/${name}.txt ${ARGN}
    RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 170)
  set(status ${status} PARENT_SCOPE)
  set(errors ${errors} PARENT_SCOPE)
endfunction()

look(simulator ${WINDOW} --task peg_transfer --threads 1)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the simulator's tool-tips are wrong: ${errors}")
endif()
look(patient_editor ${WINDOW} --edit-patient ${PATIENT})
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the patient editor's tool-tips are wrong: ${errors}")
endif()
look(plain ${PLAIN})
if(status EQUAL 0 OR NOT errors MATCHES "a tool-tip stays open")
  message(FATAL_ERROR "a tool-tip that stays open is not found: ${status} ${errors}")
endif()
