# The CMake verbs of this project: a folder's CMakeLists.txt is a few calls to these.
include_guard()

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# Options with which every target of the project is compiled.
add_library(rubric_options INTERFACE)
target_include_directories(rubric_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_features(rubric_options INTERFACE cxx_std_20)
target_compile_options(rubric_options INTERFACE -Wall -Wextra -Wshadow -Wconversion)
# They warn of what {.member = value} leaves to its default, too.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(rubric_options INTERFACE -Wno-missing-field-initializers)
elseif(CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 18)
  target_compile_options(rubric_options INTERFACE -Wno-missing-designated-field-initializers)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # It warns of overlap and bounds in its own std::string when it optimises (GCC bug 105651).
  target_compile_options(rubric_options INTERFACE -Wno-array-bounds -Wno-restrict
    -Wno-stringop-overflow -Wno-stringop-overread)
endif()
if(CMAKE_UNITY_BUILD)
  # GCC takes a type of an anonymous namespace for shared where the file is included, and clang
  # takes a local name for a shadow of another file's.
  target_compile_options(rubric_options INTERFACE
    $<IF:$<CXX_COMPILER_ID:GNU>,-Wno-subobject-linkage,-Wno-shadow>)
endif()
if(RUBRIC_WERROR)
  target_compile_options(rubric_options INTERFACE -Werror)
endif()
if(RUBRIC_SANITIZE)
  target_compile_options(rubric_options INTERFACE
    -fsanitize=${RUBRIC_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(rubric_options INTERFACE -fsanitize=${RUBRIC_SANITIZE})
endif()

if(RUBRIC_FUZZ AND RUBRIC_FUZZ_ENGINE STREQUAL "-fsanitize=fuzzer")
  # Other engines bring their instrumentation with their compiler.
  target_compile_options(rubric_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# What a Release build does beside -O2, by what tools/bench gains. WARM: GCC inlines as much in a
# unit of many files as in one of few. HOT: and -O3, which takes half as long again to compile.
# COLD, where no benchmark looks: -O1. With sanitizers, optimising takes longer than it saves in
# the tests; only HOT and BUSY have -O1 there.
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(RUBRIC_WARM --param=inline-unit-growth=1000)
  endif()
  set(RUBRIC_HOT -O3 ${RUBRIC_WARM})
  set(RUBRIC_COLD -O1)
elseif(CMAKE_BUILD_TYPE STREQUAL "Debug" AND RUBRIC_SANITIZE)
  set(RUBRIC_HOT -O1)
  set(RUBRIC_BUSY -O1)
endif()

# rubric_compile(TARGET library|test|replay [option ...]): compiles the target with the options,
# and what nearly all sources include only once for all targets of the same kind and options, as
# precompiled headers fit no others.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/headers.cc CONTENT "int main() {}\n")
function(rubric_compile target kind)
  string(MAKE_C_IDENTIFIER "rubric_${kind}_headers${ARGN}" headers)
  if(NOT TARGET ${headers})
    if(kind STREQUAL "library")
      add_library(${headers} OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/headers.cc)
    else()
      add_executable(${headers} EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/headers.cc)
    endif()
    target_compile_options(${headers} PRIVATE ${ARGN})
    target_link_libraries(${headers} PRIVATE rubric_options fmt::fmt)
    target_precompile_headers(${headers} PRIVATE <fmt/format.h> <algorithm> <array> <chrono>
      <fstream> <functional> <map> <memory> <optional> <set> <string> <variant> <vector>)
    if(kind STREQUAL "test")
      target_link_libraries(${headers} PRIVATE GTest::gmock)
      target_precompile_headers(${headers} PRIVATE <gmock/gmock.h> <gtest/gtest.h>)
    endif()
  endif()
  target_compile_options(${target} PRIVATE ${ARGN})
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()

# rubric_library(NAME [HOT|WARM|COLD] [BUSY] SOURCES a.cc ... [DEPS lib ...]): a static library.
function(rubric_library name)
  cmake_parse_arguments(arg "HOT;WARM;COLD;BUSY" "" "SOURCES;DEPS" ${ARGN})
  add_library(${name} STATIC ${arg_SOURCES})
  foreach(heat HOT WARM COLD BUSY)
    if(arg_${heat})
      list(APPEND options ${RUBRIC_${heat}})
    endif()
  endforeach()
  if(CMAKE_UNITY_BUILD)
    # The precompiled headers know fmt's macros, so that what does without fmt must know them, too.
    target_compile_definitions(${name} PRIVATE
      $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
    rubric_compile(${name} library ${options})
  else()  # Where files are compiled one by one, a missing include shows.
    target_compile_options(${name} PRIVATE ${options})
  endif()
  # Our warnings are for us: who uses an installed library has options of his own.
  target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:rubric_options> ${arg_DEPS})
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_include_directories(${name} INTERFACE $<INSTALL_INTERFACE:include/rubric>)
  set_property(GLOBAL APPEND PROPERTY RUBRIC_LIBRARIES ${name})
endfunction()

# rubric_program(NAME SOURCES a.cc ... [DEPS lib ...]): a program, at the top of the build folder.
function(rubric_program name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE rubric_options ${arg_DEPS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
endfunction()

# rubric_embed_files(OUTPUT [STEMS] FROM place HEADER h NAMESPACE n TYPE t FUNCTION f FILES ...):
# OUTPUT in the build folder defines n::f(), which h declares: a constant t of the name and content
# of each file. Paths and names are the project's; with STEMS a name is that of the file alone.
function(rubric_embed_files output)
  cmake_parse_arguments(arg "STEMS" "FROM;HEADER;NAMESPACE;TYPE;FUNCTION" "FILES" ${ARGN})
  list(TRANSFORM arg_FILES PREPEND ${PROJECT_SOURCE_DIR}/ OUTPUT_VARIABLE paths)
  list(JOIN arg_FILES " " files)
  set(script ${PROJECT_SOURCE_DIR}/spec/cmake/embed_files.cmake)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} "-DFILES=${files}" -DSTEMS=${arg_STEMS}
      -DFROM=${arg_FROM} -DHEADER=${arg_HEADER} -DNAMESPACE=${arg_NAMESPACE} "-DTYPE=${arg_TYPE}"
      -DFUNCTION=${arg_FUNCTION} -DOUT=${CMAKE_CURRENT_BINARY_DIR}/${output} -P ${script}
    DEPENDS ${paths} ${script} VERBATIM)
endfunction()

# What tests are labelled: fast, of which all together take less than a minute; slow; waits, what
# is slow as it waits for lines in real time, so that all of these run at once, after the others;
# or long, a proof that `tools/test --all` alone runs.
# FOREIGN tests read bytes of other people, so that they run under sanitizers: those of libraries
# and the replays of fuzz targets there alone in tools/test, whose optimised build has
# RUBRIC_FOREIGN_TESTS off; those of programs, and those that are COUNTED as the README says how
# much they try, with the long proofs. The targets foreign_tests and foreign_long_tests build them.
if(RUBRIC_TESTS)
  add_custom_target(foreign_tests)
  add_custom_target(foreign_long_tests)
endif()

function(rubric_label_test name label foreign targets)
  if(NOT label)
    set(label fast)
  endif()
  if(foreign)
    set(foreign_target foreign_tests)
    if("long" IN_LIST label)
      set(foreign_target foreign_long_tests)
    endif()
    list(APPEND label foreign)
    if(targets)
      add_dependencies(${foreign_target} ${targets})
    endif()
  endif()
  set(timeout_s 900)
  if("long" IN_LIST label)
    set(timeout_s 3600)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${label}" TIMEOUT ${timeout_s})
  if(NOT "fast" IN_LIST label)
    set_tests_properties(${name} PROPERTIES COST 10)  # Long ones first, so that no core idles last.
  endif()
endfunction()

# Adds a ctest entry, run from the project's folder; Python finds the modules that tests share in
# tools/tests. With PARTS n entries, which run side by side: each takes its share of the tests by
# GoogleTest's variables, which tools/tests/live_testing.py reads as well.
function(rubric_add_test name parts label foreign targets)
  if(NOT parts)
    set(parts 1)
  endif()
  foreach(part RANGE 1 ${parts})
    set(entry ${name})
    if(parts GREATER 1)
      string(APPEND entry "_${part}")
    endif()
    math(EXPR index "${part} - 1")
    add_test(NAME ${entry} COMMAND ${ARGN} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${entry} PROPERTIES
      ENVIRONMENT_MODIFICATION PYTHONPATH=path_list_prepend:${PROJECT_SOURCE_DIR}/tools/tests)
    rubric_label_test(${entry} "${label}" "${foreign}" "${targets}")
    if(parts GREATER 1)
      set_tests_properties(${entry} PROPERTIES ENVIRONMENT
        "GTEST_TOTAL_SHARDS=${parts};GTEST_SHARD_INDEX=${index}")
    endif()
  endforeach()
endfunction()

# rubric_test(NAME [FOREIGN [COUNTED]] [BUSY] SOURCES a_test.cc ... [DEPS lib ...] [PARTS n]
# [LABEL fast|slow|waits|long]): one GoogleTest program, one ctest entry or n. Tests are not
# optimised: where that costs more than compiling with optimisation, a test is BUSY.
function(rubric_test name)
  cmake_parse_arguments(arg "FOREIGN;COUNTED;BUSY" "LABEL;PARTS" "SOURCES;DEPS" ${ARGN})
  if(NOT RUBRIC_TESTS OR (arg_FOREIGN AND NOT arg_COUNTED AND NOT RUBRIC_FOREIGN_TESTS))
    return()
  endif()
  if(arg_COUNTED AND RUBRIC_SANITIZE)
    set(arg_LABEL long)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE rubric_options ${arg_DEPS} GTest::gmock GTest::gtest_main
    fmt::fmt)
  if(arg_BUSY AND CMAKE_BUILD_TYPE STREQUAL "Release")
    rubric_compile(${name} test -O1)
  else()
    rubric_compile(${name} test -O0)
  endif()
  set_property(GLOBAL APPEND PROPERTY RUBRIC_LIBRARIES_FIRST ${name})
  rubric_add_test(${name} "${arg_PARTS}" "${arg_LABEL}" "${arg_FOREIGN}" ${name} ${name})
  if(rapidcheck IN_LIST arg_DEPS)
    # A stated seed, so that a run says the same twice; only the long proofs take any seed.
    set(runs "max_success=1000 max_size=200")
    if(RUBRIC_SANITIZE)
      set(runs "max_success=250 max_size=200")
    endif()
    set_tests_properties(${name} PROPERTIES ENVIRONMENT "RC_PARAMS=seed=1 ${runs}")
    rubric_add_test(${name}_any_seed 1 long "" ${name} ${name})
    set_tests_properties(${name}_any_seed PROPERTIES ENVIRONMENT "RC_PARAMS=${runs}")
  endif()
endfunction()

# rubric_libraries_of(RESULT TARGET): RESULT gets the project's libraries that it is linked with.
function(rubric_libraries_of result target)
  get_property(ours GLOBAL PROPERTY RUBRIC_LIBRARIES)
  get_target_property(open ${target} LINK_LIBRARIES)
  while(open)
    list(POP_FRONT open one)
    if(NOT TARGET ${one} OR one IN_LIST seen)
      continue()
    endif()
    list(APPEND seen ${one})
    if(one IN_LIST ours)
      list(APPEND found ${one})
    endif()
    get_target_property(others ${one} INTERFACE_LINK_LIBRARIES)
    if(others)
      list(APPEND open ${others})
    endif()
  endwhile()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# rubric_link_libraries_first(), when all targets are there: of an inline function a linker takes
# the first copy that it meets. Tests and replays are not optimised, so it shall meet those of the
# libraries first: some tests take half as long. Where a library is one object, a program gets next
# to nothing by this that it would not have.
function(rubric_link_libraries_first)
  if(NOT CMAKE_UNITY_BUILD)
    return()
  endif()
  get_property(programs GLOBAL PROPERTY RUBRIC_LIBRARIES_FIRST)
  foreach(program ${programs})
    rubric_libraries_of(libraries ${program})
    list(TRANSFORM libraries REPLACE "(.+)" "$<TARGET_FILE:\\1>")
    list(JOIN libraries "," libraries)
    if(libraries)
      target_link_options(${program} PRIVATE
        "LINKER:--whole-archive,${libraries},--no-whole-archive")
    endif()
  endforeach()
endfunction()

# rubric_script_test(NAME [FOREIGN] [LABEL fast|slow|waits|long] [PARTS n] COMMAND word ...): a
# program or script as a ctest entry, or as n; a FOREIGN one is long under sanitizers.
function(rubric_script_test name)
  if(NOT RUBRIC_TESTS)
    return()
  endif()
  cmake_parse_arguments(arg "FOREIGN" "LABEL;PARTS" "COMMAND" ${ARGN})
  string(REGEX MATCHALL "TARGET_FILE:[a-z_-]+" targets "${arg_COMMAND}")
  list(TRANSFORM targets REPLACE "TARGET_FILE:" "")
  list(GET arg_COMMAND 0 program)
  if(TARGET ${program})
    list(APPEND targets ${program})
  endif()
  if(arg_FOREIGN AND RUBRIC_SANITIZE)
    set(arg_LABEL long)
  endif()
  rubric_add_test(${name} "${arg_PARTS}" "${arg_LABEL}" "${arg_FOREIGN}" "${targets}"
    ${arg_COMMAND})
  if(arg_FOREIGN AND NOT arg_PARTS)
    # Scripts start a program hundreds of times, a third of which would go into its last search for
    # leaks; the tests of libraries and the replays of fuzz targets search for these.
    set_tests_properties(${name} PROPERTIES ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)
  endif()
endfunction()

# rubric_have_tools(RESULT WHAT VARIABLE ...): RESULT says whether find_program or find_library set
# all of the variables. Where one is missing, WHAT is not built and not tested: that is a warning,
# and an error with RUBRIC_ALL_TOOLS.
function(rubric_have_tools result what)
  set(${result} TRUE PARENT_SCOPE)
  foreach(variable ${ARGN})
    if(NOT ${variable})
      list(APPEND missing ${variable})
    endif()
  endforeach()
  if(missing)
    set(${result} FALSE PARENT_SCOPE)
    set(severity WARNING)
    if(RUBRIC_ALL_TOOLS)
      set(severity SEND_ERROR)
    endif()
    list(JOIN missing ", " missing)
    message(${severity} "${what} is not built or tested, without ${missing}; "
      "`tools/install-packages test` installs what is needed.")
  endif()
endfunction()

# rubric_must_not_compile(NAME SOURCE x.cc REFUSALS word regex ...): compiling x.cc with each -Dword
# must fail with a message that matches its regex; without any, it must succeed.
function(rubric_must_not_compile name)
  cmake_parse_arguments(arg "" "SOURCE" "REFUSALS" ${ARGN})
  rubric_script_test(${name} COMMAND ${PROJECT_SOURCE_DIR}/spec/cmake/must_not_compile.sh
    ${CMAKE_CXX_COMPILER} ${CMAKE_CURRENT_SOURCE_DIR}/${arg_SOURCE} ${PROJECT_SOURCE_DIR}
    ${arg_REFUSALS})
endfunction()

# rubric_benchmark(NAME SOURCES a_bench.cc ... [DEPS lib ...]): a Google Benchmark program.
function(rubric_benchmark name)
  if(NOT RUBRIC_BENCH)
    return()
  endif()
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE rubric_options ${arg_DEPS} benchmark::benchmark_main)
  target_compile_options(${name} PRIVATE ${RUBRIC_HOT})
endfunction()

# rubric_fuzzer(NAME [MUTATOR lib] [DICT protocol] [MAX_LEN bytes] [SMOKE_RUNS n] [TIMEOUT seconds]
#   [REPRO] [SEEDS folder ...] [DEPS lib ...]): the fuzz target targets/NAME_fuzz.cc. With
# RUBRIC_FUZZ a program for the engine. With tests, a program built by any compiler that replays the
# corpus: corpora/NAME, if it is there, and SEEDS, folders of the project; with sanitizers it is a
# test. REPRO says that `rubric repro` writes this target's inputs as traces. What the scripts in
# fuzz/ must know goes to the build folder's fuzz_targets.tsv: name, dictionary or -, max_len, smoke
# runs, folders of the corpus, seconds that an input may take, repro or -.
function(rubric_fuzzer name)
  cmake_parse_arguments(arg "REPRO" "MUTATOR;DICT;MAX_LEN;SMOKE_RUNS;TIMEOUT" "SEEDS;DEPS" ${ARGN})
  set(target ${name}_fuzz)
  set(libraries rubric_options rubric_fuzz_support ${arg_MUTATOR} ${arg_DEPS})
  set(corpus ${arg_SEEDS})
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/corpora/${name})
    list(PREPEND corpus fuzz/corpora/${name})
  endif()
  foreach(default "DICT;-" "MAX_LEN;4096" "SMOKE_RUNS;20000" "TIMEOUT;20")
    list(POP_FRONT default option)
    if(NOT arg_${option})
      set(arg_${option} ${default})
    endif()
  endforeach()
  set(repro -)
  if(arg_REPRO)
    set(repro repro)
  endif()
  list(JOIN corpus " " folders)
  string(JOIN "\t" row ${name} ${arg_DICT} ${arg_MAX_LEN} ${arg_SMOKE_RUNS} "${folders}"
    ${arg_TIMEOUT} ${repro})
  file(APPEND ${PROJECT_BINARY_DIR}/fuzz_targets.tsv "${row}\n")
  if(RUBRIC_FUZZ)
    add_executable(${target} targets/${target}.cc)
    target_link_libraries(${target} PRIVATE ${libraries} ${RUBRIC_FUZZ_ENGINE})
  endif()
  if(RUBRIC_TESTS)
    add_executable(${target}_replay targets/${target}.cc)
    target_link_libraries(${target}_replay PRIVATE ${libraries} rubric_replay fmt::fmt)
    rubric_compile(${target}_replay replay -O0)
    set_property(GLOBAL APPEND PROPERTY RUBRIC_LIBRARIES_FIRST ${target}_replay)
    if(RUBRIC_SANITIZE)
      rubric_add_test(${target}_replay 1 fast FOREIGN ${target}_replay ${target}_replay ${corpus})
    else()
      set_target_properties(${target}_replay PROPERTIES EXCLUDE_FROM_ALL ON)
    endif()
  endif()
endfunction()
