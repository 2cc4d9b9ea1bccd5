# SPDX-License-Identifier: Apache-2.0
# Opens the device page on a virtual display beside an emulated tracker, calibrates a tip, then looks at its picture.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/config)
file(WRITE ${FOLDER}/run.sh [[
set -u
"$1" devices emulate liberty --motion tip --seconds 150 >"$2/device.txt" 2>/dev/null &
emulator=$!
trap 'kill $emulator 2>/dev/null' EXIT
for i in $(seq 100); do [ -s "$2/device.txt" ] && break; sleep 0.1; done
shift 2
"$@" --device "$(cat "$FOLDER/device.txt")"
]])
set(ENV{TROCAR_CONFIG_DIR} ${FOLDER}/config)
set(ENV{FOLDER} ${FOLDER})
execute_process(
  COMMAND sh ${FOLDER}/run.sh ${TROCAR} ${FOLDER}
    ${DBUS} -- ${XVFB} -a -s "-screen 0 1280x800x24" ${WINDOW} --devices --calibrate tip
    --screenshot ${FOLDER}/devices.png --after 8
  RESULT_VARIABLE status OUTPUT_VARIABLE report ERROR_VARIABLE errors TIMEOUT 200)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "trocar-window ended with ${status}: ${errors}")
endif()
# desktop services talk on the same line
string(REGEX MATCH "{.*}" report "${report}")
string(JSON calibrated GET "${report}" calibrated)
string(JSON residual GET "${report}" residual_mm)
if(NOT calibrated OR residual GREATER 1.0)
  message(FATAL_ERROR "the tip was not found: ${report}")
endif()
if(NOT EXISTS ${FOLDER}/config/devices.json)
  message(FATAL_ERROR "the calibration was not kept")
endif()
execute_process(COMMAND ${CHECK} ${FOLDER}/devices.png RESULT_VARIABLE status ERROR_VARIABLE errors)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the page's picture is wrong: ${errors}")
endif()
# a device that cannot be is an error in words
execute_process(COMMAND ${WINDOW} --devices --calibrate telepathy RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 60)
if(status EQUAL 0 OR NOT errors MATCHES "E-CLI-001")
  message(FATAL_ERROR "a step that does not exist gave ${status}: ${errors}")
endif()
