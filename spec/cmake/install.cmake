# Files of `cmake --install`, and the Debian packages that `cpack` makes of them:
#   tool  the programs rubric, rubricc and rubric-extcap, their manual pages, completions, the
#         Wireshark dissector, applications of `rubric run`
#   dev   headers, libraries and examples, for find_package(rubric) and pkg-config
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rubric)
set(include_dir ${CMAKE_INSTALL_INCLUDEDIR}/rubric)

# The conformance library is what `rubric test`, `check` and `explore` are made of. The libraries
# of codec and conformance belong to it, without those of tests, fuzzing, commands and compiler.
get_property(libraries GLOBAL PROPERTY RUBRIC_LIBRARIES)
list(FILTER libraries EXCLUDE REGEX "^firmware_|_mutator$|^rubric_fuzz|^rubric_(cli|\
command_line|commands|emitters|encode|format|forward|lawful_traffic|packed|script|space|specs)$")
add_library(rubric_conformance INTERFACE)
target_link_libraries(rubric_conformance INTERFACE ${libraries})
set_target_properties(rubric_conformance PROPERTIES EXPORT_NAME conformance)

install(TARGETS rubric rubricc rubric-extcap COMPONENT tool)
install(TARGETS rubric_runtime rubric_node EXPORT rubric_codec COMPONENT dev)
install(TARGETS ${libraries} rubric_conformance EXPORT rubric_conformance
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/rubric COMPONENT dev)
install(DIRECTORY codec conformance DESTINATION ${include_dir} COMPONENT dev
  FILES_MATCHING PATTERN "*.h" PATTERN "adapters" EXCLUDE PATTERN "lawful_traffic" EXCLUDE
  PATTERN "tests" EXCLUDE PATTERN "bench" EXCLUDE PATTERN "*fixture.h" EXCLUDE
  PATTERN "*testing*.h" EXCLUDE PATTERN "cases" EXCLUDE PATTERN "promela" EXCLUDE
  PATTERN "scripts" EXCLUDE)
file(GLOB node_examples CONFIGURE_DEPENDS conformance/node/examples/*.cc)
install(FILES ${node_examples}
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT dev)
# Applications of `rubric run`, which the book begins with.
file(GLOB applications CONFIGURE_DEPENDS conformance/node/examples/*.py)
install(FILES ${applications}
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT tool)
foreach(part codec conformance)
  install(EXPORT rubric_${part} NAMESPACE rubric:: DESTINATION ${config_dir} COMPONENT dev)
endforeach()

configure_package_config_file(spec/cmake/rubric-config.cmake.in rubric-config.cmake
  INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(rubric-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rubric-config.cmake
  ${PROJECT_BINARY_DIR}/rubric-config-version.cmake DESTINATION ${config_dir} COMPONENT dev)

# pkg-config files find the prefix from where they lie, so that it can be moved.
file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" pc_prefix "\${pcfiledir}/${up}")
set(pc_libraries "")
foreach(library ${libraries})
  get_target_property(type ${library} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    string(APPEND pc_libraries " -l${library}")
  endif()
endforeach()
foreach(part codec node conformance)
  configure_file(spec/cmake/rubric-${part}.pc.in rubric-${part}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/rubric-${part}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()

# Completions and manual pages are written by the program that they are about.
foreach(pair bash:bash-completion/completions/rubric zsh:zsh/site-functions/_rubric
    fish:fish/vendor_completions.d/rubric.fish)
  string(REPLACE ":" ";" pair ${pair})
  list(POP_FRONT pair shell place)
  set(file ${PROJECT_BINARY_DIR}/completion/${shell})
  add_custom_command(OUTPUT ${file}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/completion
    COMMAND rubric completion ${shell} > ${file} DEPENDS rubric VERBATIM)
  list(APPEND completions ${file})
  get_filename_component(folder ${place} DIRECTORY)
  get_filename_component(name ${place} NAME)
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/${folder} RENAME ${name}
    COMPONENT tool)
endforeach()
add_custom_target(rubric_completions ALL DEPENDS ${completions})

find_program(HELP2MAN help2man)
if(HELP2MAN)
  add_custom_command(OUTPUT man/rubric.1.gz
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/spec/cmake/man_pages.sh ${HELP2MAN} $<TARGET_FILE:rubric>
      $<TARGET_FILE:rubricc> $<TARGET_FILE:rubric-extcap> man
    DEPENDS rubric rubricc rubric-extcap spec/cmake/man_pages.sh VERBATIM)
  add_custom_target(rubric_man ALL DEPENDS man/rubric.1.gz)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
    COMPONENT tool)
else()
  message(STATUS "No help2man: manual pages are not built")
endif()
install(FILES tools/wireshark/generated/rubric.lua
  DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/wireshark COMPONENT tool)
# What the commands of README.md and the book read, under the same paths.
install(DIRECTORY conformance/protocols/ctp
  DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/conformance/protocols COMPONENT tool
  PATTERN "__pycache__" EXCLUDE PATTERN "bugs.json" EXCLUDE)
install(DIRECTORY conformance/adapters/python
  DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/conformance/adapters COMPONENT tool
  FILES_MATCHING PATTERN "*.py" PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY spec/captures/firmware spec/captures/basestation
  DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/spec/captures COMPONENT tool
  FILES_MATCHING PATTERN "*.pcapng" PATTERN "*.bin" PATTERN "*.sfstream")
install(FILES fuzz/external/compare.py
  DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/fuzz/external COMPONENT tool)
# What rubricc reads.
install(FILES spec/requirements.yaml DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/spec
  COMPONENT tool)
install(DIRECTORY spec/profiles spec/wire DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/spec
  COMPONENT tool FILES_MATCHING PATTERN "*.yaml" PATTERN "*.ksy")
install(DIRECTORY conformance/cases DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/conformance
  COMPONENT tool FILES_MATCHING PATTERN "*.rtr")
# What helps, skeletons and the book name: pages about formats, and the vectors.
file(GLOB formats RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS tools/commands/*.md)
foreach(page conformance/PORTING.md conformance/protocols/README.md spec/README.md
    spec/trace/README.md ${formats})
  cmake_path(GET page PARENT_PATH folder)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/${folder} COMPONENT tool)
endforeach()
install(DIRECTORY spec/vectors DESTINATION ${CMAKE_INSTALL_DATADIR}/rubric/spec
  COMPONENT tool FILES_MATCHING PATTERN "*.yaml" PATTERN "*.jsonl" PATTERN "README.md")
# The folders that README.md links to are not installed.
file(READ README.md readme)
string(REGEX REPLACE "\\[([^]]+)\\]\\([^)]*\\)" "\\1" readme "${readme}")
string(REPLACE "build/release/rubric" "rubric" readme "${readme}")
file(WRITE ${PROJECT_BINARY_DIR}/installed/README.md "${readme}")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS README.md)
install(FILES LICENSE ${PROJECT_BINARY_DIR}/installed/README.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tool)
# The book, if it was made: target `book`.
install(FILES ${PROJECT_BINARY_DIR}/doc/rubric.html DESTINATION ${CMAKE_INSTALL_DOCDIR}
  COMPONENT tool OPTIONAL)

add_custom_target(installable)
add_dependencies(installable rubric rubricc rubric-extcap rubric_completions ${libraries})
if(HELP2MAN)
  add_dependencies(installable rubric_man)
endif()

# What Debian's policy asks of every package.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(pair tool:rubric dev:librubric-dev)
  string(REPLACE ":" ";" pair ${pair})
  list(POP_FRONT pair part package)
  set(folder ${PROJECT_BINARY_DIR}/installed/${package})
  file(WRITE ${folder}/changelog "${package} (${PROJECT_VERSION}) unstable; urgency=medium

  * See CHANGELOG.md in the sources.

 -- Rubric maintainers <maintainers@rubric.invalid>  ${date}
")
  file(WRITE ${folder}/copyright
    "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: rubric

Files: *
Copyright: the Rubric maintainers
License: Apache-2.0
 The text is in /usr/share/common-licenses/Apache-2.0.
")
  execute_process(COMMAND gzip -9nf changelog WORKING_DIRECTORY ${folder})
  install(FILES ${folder}/changelog.gz ${folder}/copyright
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${part})
endforeach()

set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/spec/cmake/package_tools.cmake)
foreach(program rubric rubricc rubric-extcap)
  list(APPEND CPACK_RUBRIC_PROGRAMS ${PROJECT_BINARY_DIR}/${program})
endforeach()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rubric)
set(CPACK_PACKAGE_CONTACT "Rubric maintainers <maintainers@rubric.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Codec and conformance test kit for small sensor networks")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL tool dev)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_TOOL_PACKAGE_NAME rubric)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME librubric-dev)
set(CPACK_COMPONENT_TOOL_DESCRIPTION
  "Decodes captures of TinyOS active messages, judges them by the rules of the RUBICON
Communication Layer, and tests implementations against a reference machine.")
set(CPACK_COMPONENT_DEV_DESCRIPTION
  "The codec and the node (headers only), and the conformance library.")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION net)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libfmt-dev, libyaml-cpp-dev, nlohmann-json3-dev")
include(CPack)
