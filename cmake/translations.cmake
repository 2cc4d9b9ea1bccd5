# SPDX-License-Identifier: Apache-2.0
# Catalogues of texts (po/es.po), compiled to where a program in the build folder finds them. Without msgfmt all stays English.
find_program(TROCAR_MSGFMT msgfmt)
set(TROCAR_LANGUAGES es)
add_custom_target(translations ALL)
if(NOT TROCAR_MSGFMT)
  message(STATUS "Languages: English only (no msgfmt; install gettext)")
  return()
endif()
foreach(language IN LISTS TROCAR_LANGUAGES)
  set(folder ${PROJECT_BINARY_DIR}/locale/${language}/LC_MESSAGES)
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(OUTPUT ${folder}/trocar.mo
    COMMAND ${TROCAR_MSGFMT} --check -o ${folder}/trocar.mo ${PROJECT_SOURCE_DIR}/po/${language}.po
    DEPENDS ${PROJECT_SOURCE_DIR}/po/${language}.po
    COMMENT "texts: ${language}" VERBATIM)
  add_custom_target(translation_${language} DEPENDS ${folder}/trocar.mo)
  add_dependencies(translations translation_${language})
endforeach()
