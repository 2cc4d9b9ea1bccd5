# SPDX-License-Identifier: Apache-2.0
# Opens the window on a virtual display with the demonstration, then looks at the picture and the counts it reports.
file(MAKE_DIRECTORY ${FOLDER})
file(REMOVE ${FOLDER}/window.png)
execute_process(
  COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" ${WINDOW} --screenshot ${FOLDER}/window.png --after 2
  OUTPUT_FILE ${FOLDER}/report.json RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 160)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "trocar-window ended with ${status}: ${errors}")
endif()
execute_process(COMMAND ${CHECK} ${FOLDER}/window.png ${FOLDER}/report.json RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the window's picture or report is wrong")
endif()
