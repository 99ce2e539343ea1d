# isotherm_module(NAME SOURCES sources... LIBS targets...): builds a shared object isotherm-NAME.so that programs load if their
# configuration needs it (drivers/base/module.h). The file is next to libisotherm-core.so, both in the build and where it is
# installed. It exports one symbol.
function(isotherm_module name)
  cmake_parse_arguments(M "" "" "SOURCES;LIBS" ${ARGN})
  set(target isotherm-module-${name})
  set(map ${PROJECT_SOURCE_DIR}/cmake/module.map)
  add_library(${target} MODULE ${M_SOURCES})
  isotherm_target(${target})
  target_link_libraries(${target} PRIVATE ${M_LIBS})
  target_link_options(${target} PRIVATE -Wl,--version-script=${map})
  if(ISOTHERM_SANITIZE AND CMAKE_C_COMPILER_ID STREQUAL "Clang")
    # Programs in C that clang links lack the run time of these two checks of C++.
    target_compile_options(${target} PRIVATE -fno-sanitize=vptr,function)
  endif()
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME isotherm-${name} LINK_DEPENDS ${map}
    C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    LIBRARY_OUTPUT_DIRECTORY $<TARGET_FILE_DIR:isotherm-core>
    BUILD_RPATH "$ORIGIN" INSTALL_RPATH "$ORIGIN")
  install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/isotherm)
endfunction()
