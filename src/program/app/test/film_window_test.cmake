# SPDX-License-Identifier: Apache-2.0
# Saves a picture and a clip of a replay with real keys, and gives another clip up by closing the window.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/recordings)
include(${CMAKE_CURRENT_LIST_DIR}/window_run.cmake)
trocar(played play expert --task peg_transfer --seconds 3 --seed 3 --record ${FOLDER}/recordings/first.trocar)
set(ENV{TROCAR_STORE} ${FOLDER}/store.sqlite)
set(ENV{TROCAR_DATA_HOME} ${FOLDER}/data)
set(ENV{XDG_CONFIG_HOME} ${FOLDER}/config)
set(ENV{HOME} ${FOLDER})
use_window(--replay ${FOLDER}/recordings/first.trocar --recordings ${FOLDER}/recordings --threads 1)
