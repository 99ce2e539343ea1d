# isotherm_module(NAME SOURCES sources... LIBS targets...): a shared object isotherm-NAME.so that programs load when they are
# configured to (drivers/base/module.h). It lies beside libisotherm-core.so, here as where it is installed, and exports one
# symbol.
function(isotherm_module name)
  cmake_parse_arguments(M "" "" "SOURCES;LIBS" ${ARGN})
  set(target isotherm-module-${name})
  set(map ${PROJECT_SOURCE_DIR}/cmake/module.map)
  add_library(${target} MODULE ${M_SOURCES})
  isotherm_target(${target})
  target_link_libraries(${target} PRIVATE ${M_LIBS})
  target_link_options(${target} PRIVATE -Wl,--version-script=${map})
  if(ISOTHERM_SANITIZE AND CMAKE_C_COMPILER_ID STREQUAL "Clang")
    # clang's programs in C have no run time for what these check in C++.
    target_compile_options(${target} PRIVATE -fno-sanitize=vptr,function)
  endif()
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME isotherm-${name} LINK_DEPENDS ${map}
    C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    LIBRARY_OUTPUT_DIRECTORY $<TARGET_FILE_DIR:isotherm-core>
    BUILD_RPATH "$ORIGIN" INSTALL_RPATH "$ORIGIN")
  install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/isotherm)
endfunction()
