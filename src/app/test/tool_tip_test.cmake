# SPDX-License-Identifier: Apache-2.0
# Opens the window on a virtual display, as for a person, and looks how long the tool-tips of its buttons stay.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
file(WRITE ${FOLDER}/run.sh [[
set -u
"$1" --task peg_transfer --threads 1 >"$2/window.txt" 2>&1 &
window=$!
"$3"
status=$?
kill $window 2>/dev/null
wait $window 2>/dev/null
exit $status
]])
set(ENV{GTK_A11Y} none)
execute_process(
  COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" sh ${FOLDER}/run.sh ${WINDOW} ${FOLDER} ${CHECK}
  RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 170)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the tool-tips are wrong: ${errors}")
endif()
