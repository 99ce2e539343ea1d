# Options for instrumented builds: sanitizers, coverage, fuzzing. They apply to every target.
set(ISOTHERM_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize= (such as address,undefined)")
option(ISOTHERM_COVERAGE "Count executed lines and branches (gcov)" OFF)
option(ISOTHERM_FUZZ "Build the libFuzzer targets of tests/fuzz (clang only)" OFF)

if(ISOTHERM_SANITIZE)
  # An error that a sanitizer finds ends the program, so that the test fails.
  add_compile_options(-fsanitize=${ISOTHERM_SANITIZE} -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${ISOTHERM_SANITIZE})
endif()

if(ISOTHERM_COVERAGE)
  add_compile_options(--coverage)
  add_link_options(--coverage)
endif()

if(ISOTHERM_FUZZ)
  if(NOT CMAKE_C_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "ISOTHERM_FUZZ needs clang: use the preset `fuzz`")
  endif()
  # All code is instrumented to count executed edges; only the fuzz targets get libFuzzer's main().
  add_compile_options(-fsanitize=fuzzer-no-link)
  add_link_options(-fsanitize=fuzzer-no-link)
endif()
