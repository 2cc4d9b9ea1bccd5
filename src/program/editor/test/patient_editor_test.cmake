# SPDX-License-Identifier: Apache-2.0
# Opens the patient editor on a virtual display, then looks at its picture.
file(MAKE_DIRECTORY ${FOLDER})
file(REMOVE ${FOLDER}/editor.png)
execute_process(
  COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" ${WINDOW} --edit-patient ${PATIENT} --tool paint
    --screenshot ${FOLDER}/editor.png --after 4
  RESULT_VARIABLE status ERROR_VARIABLE errors OUTPUT_QUIET TIMEOUT 160)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "trocar-window ended with ${status}: ${errors}")
endif()
execute_process(COMMAND ${CHECK} ${FOLDER}/editor.png RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the editor's picture is wrong")
endif()
# a patient that is not there is an error with its code
execute_process(
  COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" ${WINDOW} --edit-patient ${FOLDER}/nobody
    --screenshot ${FOLDER}/nobody.png --after 1
  RESULT_VARIABLE status ERROR_VARIABLE errors OUTPUT_QUIET TIMEOUT 160)
if(status EQUAL 0 OR NOT errors MATCHES "E-IO-001")
  message(FATAL_ERROR "a missing patient gave ${status}: ${errors}")
endif()
