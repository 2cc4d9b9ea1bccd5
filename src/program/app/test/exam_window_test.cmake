# SPDX-License-Identifier: Apache-2.0
# Sits a sealed exam in the window and issues its certificate there, with an encrypted key; the command line verifies it.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/recordings)
include(${CMAKE_CURRENT_LIST_DIR}/window_run.cmake)
set(ENV{TROCAR_KEY_PASSPHRASE} "seven green herons")
trocar(made certificate keygen -o ${FOLDER}/centre)
set(ENV{TROCAR_KEY_PASSPHRASE})  # the examiner types it
trocar(sealed exam seal --task instrument_navigation --level easy --name Finals -o ${FOLDER}/finals.json)

use_window(--page exam --exam ${FOLDER}/finals.json --trainee "Anna Berg" --recordings ${FOLDER}/recordings
  --store ${FOLDER}/store.sqlite --threads 1)

file(GLOB recordings ${FOLDER}/recordings/*.trocar)
list(LENGTH recordings count)
if(NOT count EQUAL 1)
  message(FATAL_ERROR "one exam was sat, and there are ${count} recordings")
endif()
trocar(verified certificate verify ${FOLDER}/certificate.json ${recordings} --key ${FOLDER}/centre.pub)
if(NOT verified MATCHES "^VERIFIED" OR NOT verified MATCHES "examinee +T-......\n" OR NOT verified MATCHES "completed +no\n")
  message(FATAL_ERROR "the certificate is of something else: ${verified}")
endif()
# a person's name is in no certificate and no recording
execute_process(COMMAND grep -rl "Anna Berg" ${FOLDER} OUTPUT_VARIABLE named)
if(NOT named MATCHES "^[^\n]*names.json\n$")
  message(FATAL_ERROR "the name lies in ${named}")
endif()
