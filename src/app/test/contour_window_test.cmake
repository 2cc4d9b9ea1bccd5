# SPDX-License-Identifier: Apache-2.0
# Opens the contour window on a virtual display, plays a script, then looks at the picture and the report.
file(REMOVE_RECURSE ${FOLDER})
execute_process(COMMAND ${CHECK} make ${FOLDER} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the slices cannot be made")
endif()
execute_process(
  COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" ${WINDOW} --contours ${FOLDER}/slices --pixel-mm 1
    --slice-mm 6 --axes left,posterior,inferior --script ${FOLDER}/contours.script
    --screenshot ${FOLDER}/window.png --after 1
  OUTPUT_FILE ${FOLDER}/report.json RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 170)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "trocar-window ended with ${status}: ${errors}")
endif()
execute_process(COMMAND ${CHECK} check ${FOLDER}/window.png ${FOLDER}/report.json RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the window's picture or report is wrong")
endif()
