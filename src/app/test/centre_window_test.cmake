# SPDX-License-Identifier: Apache-2.0
# Plays a little in the window with real keys, finishes, and looks at the pages; the store has the attempt, of the right person.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/recordings)
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
  COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" sh ${FOLDER}/run.sh ${CHECK} ${FOLDER} ${WINDOW}
    --task instrument_navigation --level easy --recordings ${FOLDER}/recordings --store ${FOLDER}/store.sqlite
    --trainee "Anna Berg" --threads 1
  RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 400)
if(NOT status EQUAL 0)
  file(READ ${FOLDER}/output.txt output)
  message(FATAL_ERROR "the window: ${errors}\n${output}")
endif()

execute_process(COMMAND ${TROCAR} store attempts --store ${FOLDER}/store.sqlite --json OUTPUT_VARIABLE text
  RESULT_VARIABLE status TIMEOUT 60)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "trocar store attempts ended with ${status}: ${text}")
endif()
string(JSON count LENGTH "${text}" attempts)
if(count LESS 1)
  message(FATAL_ERROR "the store has no attempt: ${text}")
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
