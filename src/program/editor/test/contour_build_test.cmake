# SPDX-License-Identifier: Apache-2.0
# Recovers an unsaved session on a virtual display, saves it, gives one patient up and builds another; then opens the
# file while another program holds it.
file(REMOVE_RECURSE ${FOLDER})
execute_process(COMMAND ${TROCAR} anatomy phantom --seed 7 --pixel-mm 1.6 --slice-mm 2 --every 4 -o ${FOLDER}/phantom
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE errors)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the phantom cannot be made: ${errors}")
endif()
# the file has one organ less than what the last session had not saved
file(READ ${FOLDER}/phantom/control_points.json whole)
string(JSON structures GET "${whole}" structures)
string(JSON count LENGTH "${structures}")
set(slices 0)
math(EXPR last "${count} - 1")
foreach(i RANGE ${last})
  string(JSON n LENGTH "${structures}" ${i} slices)
  math(EXPR slices "${slices} + ${n}")
endforeach()
string(JSON half REMOVE "${whole}" structures ${last})
file(WRITE ${FOLDER}/points.json "${half}")
file(WRITE ${FOLDER}/points.json.autosave "${whole}")

function(play script report)
  file(WRITE ${FOLDER}/${report}.script "${script}")
  execute_process(
    COMMAND ${ARGN} ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" ${WINDOW} --contours ${FOLDER}/phantom/slices
      --points ${FOLDER}/points.json --script ${FOLDER}/${report}.script --autosave
      --screenshot ${FOLDER}/${report}.png --after 1
    OUTPUT_FILE ${FOLDER}/${report}.json RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 170)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "trocar-window ended with ${status}: ${errors}")
  endif()
endfunction()

play("answer Go on with it
save ${FOLDER}/points.json
build ${FOLDER}/given-up
stop-build
await build
build ${FOLDER}/built
await build
" report)
execute_process(COMMAND ${CHECK} check-built ${FOLDER} ${slices} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "recovering, saving or building went wrong")
endif()

file(WRITE ${FOLDER}/points.json.autosave "${half}")
play("answer Go on without autosave\n" second ${FLOCK} ${FOLDER}/points.json.autosave.lock)
execute_process(COMMAND ${CHECK} check-second ${FOLDER} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "a second window works on the first one's side file")
endif()
