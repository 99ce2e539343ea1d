# isotherm_target(NAME): the flags of every target of the project.
option(ISOTHERM_WERROR "Treat warnings as errors" ON)

# The largest permitted stack frame of a function, in bytes: programs work with a stack of 256 KiB (drivers/process/limits.h). The limit
# does not apply to sanitizers and code without optimisation, which need more for the same variables, nor to tests.
set(ISOTHERM_FRAME_BYTES_MAX 16384)

function(isotherm_frames_bounded name)
  if(NOT ISOTHERM_SANITIZE AND NOT ISOTHERM_COVERAGE AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
    target_compile_options(${name} PRIVATE -Wframe-larger-than=${ISOTHERM_FRAME_BYTES_MAX})
  endif()
endfunction()

function(isotherm_target name)
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/core/include>)
  target_compile_definitions(${name} PRIVATE _GNU_SOURCE
    ISOTHERM_VERSION="${PROJECT_VERSION}"
    ISOTHERM_DATA_DIR="${CMAKE_INSTALL_FULL_DATADIR}/isotherm")
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wconversion -Wshadow -Wvla -Walloca -fno-math-errno
    $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes> $<$<COMPILE_LANGUAGE:C>:-Wmissing-prototypes>)
  if(NOT CMAKE_CURRENT_SOURCE_DIR MATCHES "^${PROJECT_SOURCE_DIR}/tests")
    isotherm_frames_bounded(${name})
  endif()
  if(ISOTHERM_WERROR)
    target_compile_options(${name} PRIVATE -Werror)
  endif()
endfunction()

# isotherm_find_in_rooms(OUT SOURCES...): finds the paths of sources in the folder of the CMakeLists.txt or in one of its subfolders, in
# which each name is unique.
function(isotherm_find_in_rooms out)
  set(found)
  foreach(source ${ARGN})
    if(NOT EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source} AND NOT source MATCHES "/")
      file(GLOB matches CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*/${source})
      list(LENGTH matches n)
      if(NOT n EQUAL 1)
        message(FATAL_ERROR "${CMAKE_CURRENT_SOURCE_DIR}: ${n} rooms hold a file ${source}")
      endif()
      set(source ${matches})
    endif()
    list(APPEND found ${source})
  endforeach()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# isotherm_test(NAME SOURCES... LIBS targets...): makes one cmocka program, which is one ctest. Its last line says why it failed.
function(isotherm_test name)
  cmake_parse_arguments(T "" "" "SOURCES;LIBS" ${ARGN})
  isotherm_find_in_rooms(sources ${T_SOURCES})
  add_executable(${name} ${sources} $<TARGET_OBJECTS:isotherm-test-words>)
  isotherm_target(${name})
  target_link_libraries(${name} PRIVATE ${T_LIBS} PkgConfig::CMOCKA)
  target_compile_definitions(${name} PRIVATE ISOTHERM_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    ISOTHERM_BINARY_DIR="${PROJECT_BINARY_DIR}")
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77)
endfunction()
