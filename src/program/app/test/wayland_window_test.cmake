# SPDX-License-Identifier: Apache-2.0
# Under Wayland the compositor holds the pointer: pushed far beyond the display's edge and as far back, the hand is where it was. Where
# it does not (the control, whose compositor grants no lock), the hand stops at the edge and ends elsewhere. There a pointer that leaves the
# window and comes in at another place moves nothing by that, and the hand goes on.
file(REMOVE_RECURSE ${FOLDER})
file(WRITE ${FOLDER}/run.sh [[
set -u
check=$1 folder=$2 sway=$3 constraint=$4 use=$5 width=$6 place=$7
shift 7
export XDG_RUNTIME_DIR=$(mktemp -d) WLR_BACKENDS=headless WLR_RENDERER=pixman WLR_LIBINPUT_NO_DEVICES=1 LIBGL_ALWAYS_SOFTWARE=1
export SWAYSOCK=$XDG_RUNTIME_DIR/sway WAYLAND_DISPLAY=wayland-1 GDK_BACKEND=wayland
unset DISPLAY
cat >"$XDG_RUNTIME_DIR/config" <<CONFIG
output HEADLESS-1 resolution ${width}x800
default_border none
xwayland disable
seat seat0 pointer_constraint $constraint
for_window [app_id=".*"] $place
CONFIG
# it does not run as root
if [ "$(id -u)" = 0 ]; then
  chown -R nobody "$XDG_RUNTIME_DIR"
  env --unset=WAYLAND_DISPLAY setpriv --reuid=nobody --regid=nogroup --clear-groups "$sway" -c "$XDG_RUNTIME_DIR/config" >"$folder/sway.txt" 2>&1 &
else
  env --unset=WAYLAND_DISPLAY "$sway" -c "$XDG_RUNTIME_DIR/config" >"$folder/sway.txt" 2>&1 &
fi
compositor=$!
wait_for() { for _ in $(seq 300); do if "$@"; then return 0; fi; sleep 0.2; done; echo "no: $*" >&2; return 1; }
is_open() { ls "$folder"/recordings/*.trocar >/dev/null 2>&1; }
status=1
if wait_for test -S "$XDG_RUNTIME_DIR/wayland-1"; then
  "$@" >"$folder/output.txt" 2>&1 &
  window=$!
  if wait_for is_open; then
    sleep 8
    "$check" $use
    status=$?
  fi
  # the second time it does not ask
  for _ in 1 2; do swaymsg '[app_id=".*"]' kill >/dev/null; sleep 2; done
  if kill -0 $window 2>/dev/null; then kill $window; fi
  wait $window
fi
kill $compositor 2>/dev/null
wait $compositor 2>/dev/null
rm -rf "$XDG_RUNTIME_DIR"
exit $status
]])
set(ENV{GTK_A11Y} none)

# use_hand(CONSTRAINT USE WIDTH PLACE OUTPUT...): how far the hand went aside, at most and at the end, and up or down at the end [mrad]
function(use_hand constraint use width place most last tilt)
  file(REMOVE_RECURSE ${FOLDER}/recordings)
  file(MAKE_DIRECTORY ${FOLDER}/recordings)
  execute_process(
    COMMAND ${DBUS} -- sh ${FOLDER}/run.sh ${CHECK} ${FOLDER} ${SWAY} ${constraint} ${use} ${width} ${place} ${WINDOW} --task peg_transfer
      --settings ${FOLDER}/window.json --recordings ${FOLDER}/recordings --store ${FOLDER}/store.sqlite --threads 1
    RESULT_VARIABLE status ERROR_VARIABLE errors TIMEOUT 200)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "the window under Wayland: ${errors}")
  endif()
  file(GLOB recordings ${FOLDER}/recordings/*.trocar)
  execute_process(COMMAND ${CHECK} judge ${recordings} OUTPUT_VARIABLE found ERROR_VARIABLE errors RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "the recording: ${errors}")
  endif()
  list(GET found 0 far)
  list(GET found 1 end)
  list(GET found 2 turned)
  message(STATUS "constraint ${constraint}, ${use}: ${far} mrad aside at most, ${end} at the end, ${turned} up or down")
  set(${most} ${far} PARENT_SCOPE)
  set(${last} ${end} PARENT_SCOPE)
  set(${tilt} ${turned} PARENT_SCOPE)
endfunction()

use_hand(enable push 1280 "fullscreen enable" held_most held_last held_tilt)
use_hand(disable push 1280 "fullscreen enable" free_most free_last free_tilt)
use_hand(disable leave 2000 "floating enable, move absolute position 0 0" left_most left_last left_tilt)
# the way of a tip in the picture is no even turn of its shaft: a tenth is left
math(EXPR held_tenths "10 * ${held_last}")
if(held_most LESS 100 OR held_tenths GREATER held_most)
  message(FATAL_ERROR "held, the hand should go far and come back")
endif()
if(free_last GREATER -100)
  message(FATAL_ERROR "the control: without a lock the way back should be longer than the way there")
endif()
math(EXPR left_tenths "10 * (${left_most} - ${left_last})")
if(left_most LESS 100 OR left_tenths GREATER left_most)
  message(FATAL_ERROR "where the pointer came in again, the hand should be where it was left")
endif()
if(left_tilt LESS 50)
  message(FATAL_ERROR "in the window again, the hand should go on")
endif()
