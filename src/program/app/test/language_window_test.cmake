# SPDX-License-Identifier: Apache-2.0
# Opens the window in English, again in English, and in Spanish, and compares what the header bar says. Nobody says anything on
# standard error that is not said in English, too.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
set(ENV{GTK_A11Y} none)
set(ENV{TROCAR_STORE} ${FOLDER}/store.sqlite)
set(ENV{LC_ALL} C.UTF-8)
foreach(name english again spanish)
  set(ENV{LANGUAGE} en)
  if(name STREQUAL "spanish")
    set(ENV{LANGUAGE} es)
  endif()
  execute_process(
    COMMAND ${DBUS} -- ${XVFB} -a -s "-screen 0 1440x900x24" ${WINDOW} --task peg_transfer --after 2 --screenshot ${FOLDER}/${name}.png
    OUTPUT_QUIET ERROR_VARIABLE said_${name} RESULT_VARIABLE status TIMEOUT 180)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "trocar-window (${name}) ended with ${status}: ${said_${name}}")
  endif()
endforeach()
execute_process(COMMAND ${CHECK} ${FOLDER}/english.png ${FOLDER}/again.png ${FOLDER}/spanish.png
  RESULT_VARIABLE status ERROR_VARIABLE errors)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${errors}")
endif()
if(said_spanish MATCHES "E-[A-Z]+-[0-9]+" AND NOT said_english MATCHES "E-[A-Z]+-[0-9]+")
  message(FATAL_ERROR "the Spanish window complains: ${said_spanish}")
endif()
