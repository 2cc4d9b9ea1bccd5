# SPDX-License-Identifier: Apache-2.0
# Opens the window with the list of tasks, then with a task that the scripted expert ends, and looks at both pictures.
file(MAKE_DIRECTORY ${FOLDER})
foreach(card list result)
  file(REMOVE ${FOLDER}/${card}.png)
  if(card STREQUAL "list")
    set(arguments --tasks --after 0.5)
  else()
    set(arguments --task clip_and_cut --after 15)
  endif()
  execute_process(
    COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" ${WINDOW} ${arguments} --screenshot ${FOLDER}/${card}.png
    OUTPUT_FILE ${FOLDER}/${card}.json RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 400)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "trocar-window ${arguments} ended with ${status}: ${errors}")
  endif()
  execute_process(COMMAND ${CHECK} ${card} ${FOLDER}/${card}.png ${FOLDER}/${card}.json RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "the picture or the report of the ${card} is wrong")
  endif()
endforeach()
