# SPDX-License-Identifier: Apache-2.0
# What tests of windows share: the command line, and a window on a display of its own with somebody who uses it.
function(trocar output)
  execute_process(COMMAND ${TROCAR} ${ARGN} OUTPUT_VARIABLE text ERROR_VARIABLE errors RESULT_VARIABLE status TIMEOUT 200)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "trocar ${ARGN} ended with ${status}: ${text} ${errors}")
  endif()
  set(${output} "${text}" PARENT_SCOPE)
endfunction()

# use_window(ARGS...): opens the window with these arguments; CHECK uses it and closes it
function(use_window)
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
  execute_process(
    COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" sh ${FOLDER}/run.sh ${CHECK} ${FOLDER} ${WINDOW} ${ARGN}
    RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 400)
  if(NOT status EQUAL 0)
    file(READ ${FOLDER}/output.txt output)
    message(FATAL_ERROR "the window: ${errors}\n${output}")
  endif()
endfunction()

# find_recording(VARIABLE): what `trocar record info` says of the one attempt that was made
function(find_recording output)
  file(GLOB recordings ${FOLDER}/recordings/*.trocar)
  list(LENGTH recordings count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR "one attempt was made, and there are ${count} recordings")
  endif()
  trocar(info record info ${recordings} --json)
  set(${output} "${info}" PARENT_SCOPE)
endfunction()

# Fails where the window that was closed last had complaints of GTK.
function(check_warnings)
  file(READ ${FOLDER}/output.txt output)
  if(output MATCHES "Gtk-(WARNING|CRITICAL)")
    message(FATAL_ERROR "GTK complains: ${output}")
  endif()
endfunction()
