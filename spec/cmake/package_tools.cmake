# Tools that cpack needs: without the first, packages would silently depend on nothing.
foreach(program dpkg-shlibdeps file)
  find_program(found_${program} ${program})
  if(NOT found_${program})
    message(FATAL_ERROR "${program}: not found; Debian packages need it: "
      "apt-get install dpkg-dev file")
  endif()
endforeach()
