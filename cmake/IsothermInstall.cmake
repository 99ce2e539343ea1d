# What developers get: the library, its headers and isotherm.pc. Each folder installs its own programs and manuals.
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/isotherm)

install(TARGETS isotherm-core LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})

# Headers include one another as "core/...", so they keep their tree below include/isotherm. What only the library's own
# sources include stays at home.
install(DIRECTORY core DESTINATION ${headers} FILES_MATCHING PATTERN "*.h"
  REGEX "/core/include" EXCLUDE
  PATTERN "extract_workspace.h" EXCLUDE
  REGEX "/(lanes|block|permuted|chebyshev|grid_stencil|grid_step|grid_band|level_search|tracer_store)[.]h$" EXCLUDE
  PATTERN "template_points.h" EXCLUDE
  PATTERN "lanczos.h" EXCLUDE
  REGEX "/shape/(collaborative|describe|gallery|principal|vocabulary)[.]h$" EXCLUDE
  PATTERN "data" EXCLUDE)
install(DIRECTORY core/include/isotherm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")

install(DIRECTORY core/data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/isotherm
  FILES_MATCHING PATTERN "*.model" PATTERN "*.templates" PATTERN "*.metric")
install(FILES LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_file(cmake/isotherm.pc.in isotherm.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/isotherm.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
