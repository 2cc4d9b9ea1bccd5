# SPDX-License-Identifier: Apache-2.0
# Works in the window with real mouse motion, wheel and keys alone; what was recorded says that the first goal was reached.
set(FOLDER ${FOLDER}/${TASK})
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/recordings)
file(WRITE ${FOLDER}/run.sh [[
set -u
check=$1 task=$2 level=$3 folder=$4
shift 4
"$@" >"$folder/output.txt" 2>&1 &
window=$!
"$check" "$task" "$level" "$folder"
status=$?
if [ $status -ne 0 ]; then kill $window 2>/dev/null; fi
wait $window
ended=$?
if [ $status -eq 0 ] && [ $ended -ne 0 ]; then echo "the window ended with $ended" >&2; status=1; fi
exit $status
]])
set(ENV{GTK_A11Y} none)
execute_process(
  COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" sh ${FOLDER}/run.sh ${CHECK} ${TASK} ${LEVEL} ${FOLDER} ${WINDOW}
    --task ${TASK} --level ${LEVEL} --settings ${FOLDER}/window.json --recordings ${FOLDER}/recordings
    --store ${FOLDER}/store.sqlite --threads 1
  RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 500)
if(NOT status EQUAL 0)
  file(READ ${FOLDER}/output.txt output)
  message(FATAL_ERROR "${TASK} by mouse and keys: ${errors}\n${output}")
endif()
file(GLOB recordings ${FOLDER}/recordings/*_${TASK}.trocar)
list(LENGTH recordings count)
if(NOT count EQUAL 1)
  message(FATAL_ERROR "one attempt was made, and there are ${count} recordings")
endif()
execute_process(COMMAND ${TROCAR} record info ${recordings} --json OUTPUT_VARIABLE info RESULT_VARIABLE status TIMEOUT 60)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "trocar record info ended with ${status}: ${info}")
endif()
string(JSON done GET "${info}" outcome task goals 0 done)
if(NOT done)
  message(FATAL_ERROR "the first goal was not reached: ${info}")
endif()
