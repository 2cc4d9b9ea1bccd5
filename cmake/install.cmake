# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts where: programs, their data, and the libraries for programs outside this tree.
# tools/build-package makes Debian packages of it.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Programs. Those that only other programs start lie in libexec, where they are looked for.
install(TARGETS trocar RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
install(TARGETS trocar-training trocar-anatomy trocar-research trocar-import trocar-supervisor
  RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/trocar COMPONENT programs)
install(TARGETS trocar-postgres LIBRARY DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/trocar COMPONENT programs)
if(TARGET trocar-window)
  install(TARGETS trocar-window RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
  install(FILES packaging/org.trocar.Trocar.desktop
    DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT programs)
  install(FILES packaging/org.trocar.Trocar.metainfo.xml
    DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT programs)
  install(FILES packaging/org.trocar.Trocar.svg
    DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT programs)
endif()

# Rights of devices and of the real-time loop. udev and PAM read them where the prefix is /usr.
install(FILES packaging/60-trocar.rules DESTINATION lib/udev/rules.d COMPONENT programs)
install(FILES packaging/limits.conf DESTINATION ${CMAKE_INSTALL_FULL_SYSCONFDIR}/security/limits.d
  RENAME trocar.conf COMPONENT programs)

# Manual pages, from what each command prints as its help; only where they were made (ninja man_pages).
find_program(TROCAR_PYTHON3 python3)
if(TROCAR_PYTHON3)
  add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/man/trocar.1
    COMMAND ${TROCAR_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/make-man-pages $<TARGET_FILE:trocar> ${PROJECT_BINARY_DIR}/man
    DEPENDS trocar trocar-training trocar-anatomy trocar-research ${PROJECT_SOURCE_DIR}/tools/make-man-pages
    COMMENT "manual pages" VERBATIM)
  add_custom_target(man_pages DEPENDS ${PROJECT_BINARY_DIR}/man/trocar.1)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs
    OPTIONAL FILES_MATCHING PATTERN "*.1")
  if(TROCAR_MSGFMT)
    foreach(language IN LISTS TROCAR_LANGUAGES)
      set(folder ${PROJECT_BINARY_DIR}/man-${language})
      add_custom_command(OUTPUT ${folder}/trocar.1
        COMMAND ${TROCAR_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/make-man-pages $<TARGET_FILE:trocar> ${folder} ${language}
        DEPENDS trocar trocar-training trocar-anatomy trocar-research translation_${language} ${PROJECT_SOURCE_DIR}/po/${language}.po ${PROJECT_SOURCE_DIR}/tools/make-man-pages
        COMMENT "manual pages: ${language}" VERBATIM)
      add_custom_target(man_pages_${language} DEPENDS ${folder}/trocar.1)
      add_dependencies(man_pages man_pages_${language})
      install(DIRECTORY ${folder}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/${language}/man1 COMPONENT programs
        OPTIONAL FILES_MATCHING PATTERN "*.1")
    endforeach()
  endif()
endif()

# Data. A program in bin/ finds it in ../share/trocar.
install(DIRECTORY assets scenes schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/trocar COMPONENT data)
# States from which parts of the operation begin; only where they were made (ninja operation_parts), which takes minutes. States that
# are there already are kept.
add_custom_target(operation_parts)
foreach(level easy normal hard)
  add_custom_target(operation_parts_${level}
    COMMAND ${CMAKE_COMMAND} -E env TROCAR_DATA_DIR=${PROJECT_SOURCE_DIR} $<TARGET_FILE:trocar> course prepare
      cholecystectomy --level ${level} -o ${PROJECT_BINARY_DIR}/parts
    COMMENT "parts of the operation: ${level}" VERBATIM)
  add_dependencies(operation_parts_${level} trocar trocar-training)
  add_dependencies(operation_parts operation_parts_${level})
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/parts/ DESTINATION ${CMAKE_INSTALL_DATADIR}/trocar/parts COMPONENT data OPTIONAL
  FILES_MATCHING PATTERN "*.state")
# `trocar dataset verify` starts it
install(PROGRAMS tools/verify-dataset DESTINATION ${CMAKE_INSTALL_DATADIR}/trocar/tools COMPONENT data)

install(DIRECTORY ${PROJECT_BINARY_DIR}/locale/ DESTINATION ${CMAKE_INSTALL_LOCALEDIR} COMPONENT data OPTIONAL
  FILES_MATCHING PATTERN "*.mo")

# Libraries: all modules but those that only our own programs use.
set(exported ${TROCAR_MODULES})
list(REMOVE_ITEM exported assessment store report gui centre editor rehearsal presenter app bench study dataset doctor cli)
set(exported_targets)
foreach(module IN LISTS exported)
  if(TARGET trocar_${module})
    set_target_properties(trocar_${module} PROPERTIES EXPORT_NAME ${module})
    list(APPEND exported_targets trocar_${module})
  endif()
endforeach()
add_custom_target(libraries DEPENDS ${exported_targets})
set_target_properties(trocar_compile_options PROPERTIES EXPORT_NAME compile_options)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Trocar)
# the engine in a list of its own: whoever uses it alone needs no other library than its own
set(engine_targets trocar_compile_options)
set(other_targets)
foreach(module IN LISTS exported)
  if(EXISTS ${PROJECT_SOURCE_DIR}/src/engine/${module} OR EXISTS ${PROJECT_SOURCE_DIR}/src/procedure/${module})
    list(APPEND engine_targets trocar_${module})
  elseif(TARGET trocar_${module})
    list(APPEND other_targets trocar_${module})
  endif()
endforeach()
foreach(list Engine Other)
  string(TOLOWER ${list} name)
  install(TARGETS ${${name}_targets} EXPORT Trocar${list}Targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
  install(EXPORT Trocar${list}Targets NAMESPACE Trocar:: DESTINATION ${package_folder} COMPONENT development)
endforeach()
configure_package_config_file(cmake/TrocarConfig.cmake.in ${PROJECT_BINARY_DIR}/TrocarConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/TrocarConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/TrocarConfig.cmake ${PROJECT_BINARY_DIR}/TrocarConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT development)

# what an installation holds
add_custom_target(installation DEPENDS programs libraries)
if(TARGET man_pages)
  add_dependencies(installation man_pages)
endif()
