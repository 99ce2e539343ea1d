# isotherm_target(NAME): what every target of the project is compiled with.
option(ISOTHERM_WERROR "Treat warnings as errors" ON)

function(isotherm_target name)
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_compile_definitions(${name} PRIVATE _GNU_SOURCE
    ISOTHERM_VERSION="${PROJECT_VERSION}"
    ISOTHERM_DATA_DIR="${CMAKE_INSTALL_FULL_DATADIR}/isotherm")
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wconversion -Wshadow -Wvla -fno-math-errno
    $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes> $<$<COMPILE_LANGUAGE:C>:-Wmissing-prototypes>)
  if(ISOTHERM_WERROR)
    target_compile_options(${name} PRIVATE -Werror)
  endif()
endfunction()

# isotherm_test(NAME SOURCES... LIBS targets...): one cmocka program is one ctest. Its last line says why it failed.
function(isotherm_test name)
  cmake_parse_arguments(T "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${T_SOURCES} $<TARGET_OBJECTS:isotherm-test-words>)
  isotherm_target(${name})
  target_link_libraries(${name} PRIVATE ${T_LIBS} PkgConfig::CMOCKA)
  target_compile_definitions(${name} PRIVATE ISOTHERM_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    ISOTHERM_BINARY_DIR="${PROJECT_BINARY_DIR}")
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77)
endfunction()
