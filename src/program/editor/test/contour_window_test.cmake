# SPDX-License-Identifier: Apache-2.0
# Opens the contour window on a virtual display, plays a script, then looks at the picture and the report.
file(REMOVE_RECURSE ${FOLDER})
execute_process(COMMAND ${CHECK} make ${FOLDER} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the slices cannot be made")
endif()
# a window that ends at once leaves the service behind that its accessibility asked for, which would hold a pipe open
set(ENV{GTK_A11Y} none)
function(draw script)
  execute_process(
    COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" ${WINDOW} --contours ${FOLDER}/slices ${ARGN}
      --script ${script} --screenshot ${FOLDER}/window.png --after 1
    OUTPUT_FILE ${FOLDER}/report.json ERROR_FILE ${FOLDER}/errors.txt RESULT_VARIABLE status TIMEOUT 70)
  file(READ ${FOLDER}/errors.txt errors)
  set(status ${status} PARENT_SCOPE)
  set(errors ${errors} PARENT_SCOPE)
endfunction()

function(draw_and_check)
  file(REMOVE ${FOLDER}/window.png)
  draw(${ARGN})
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "trocar-window ended with ${status}: ${errors}")
  endif()
  execute_process(COMMAND ${CHECK} check ${FOLDER}/window.png ${FOLDER}/report.json RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "the window's picture or report is wrong")
  endif()
endfunction()

draw_and_check(${FOLDER}/contours.script --pixel-mm 1 --slice-mm 6 --axes left,posterior,inferior)
# pictures do not say their sizes: the window asks for them
file(READ ${FOLDER}/contours.script script)
file(WRITE ${FOLDER}/sizes.script "sizes 1 6 left posterior inferior\n${script}")
draw_and_check(${FOLDER}/sizes.script)
file(WRITE ${FOLDER}/wrong.script "sizes 1 6 left right inferior\n${script}")
draw(${FOLDER}/wrong.script)
if(status EQUAL 0 OR NOT errors MATCHES "E-SCN-002.*Columns, rows and slices")
  message(FATAL_ERROR "sizes that cannot be gave ${status}: ${errors}")
endif()
# nobody is there to answer
draw(${FOLDER}/contours.script)
if(status EQUAL 0 OR NOT errors MATCHES "E-IMG-005")
  message(FATAL_ERROR "sizes that nobody says gave ${status}: ${errors}")
endif()
