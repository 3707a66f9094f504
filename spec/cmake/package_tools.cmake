# Finds which packages the programs depend on. What cpack does for that itself starts two processes
# for each of 1,000 files, which took more time than all else.
find_program(shlibdeps dpkg-shlibdeps)
if(NOT shlibdeps)
  message(FATAL_ERROR "dpkg-shlibdeps: not found; Debian packages need it: "
    "apt-get install dpkg-dev")
endif()
set(folder ${CPACK_PACKAGE_DIRECTORY}/_shlibdeps)
file(WRITE ${folder}/debian/control "Source: rubric\n\nPackage: rubric\nArchitecture: any\n")
execute_process(COMMAND ${shlibdeps} -O ${CPACK_RUBRIC_PROGRAMS} WORKING_DIRECTORY ${folder}
  OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE_RECURSE ${folder})
string(REPLACE "shlibs:Depends=" "" CPACK_DEBIAN_TOOL_PACKAGE_DEPENDS "${found}")
