# Data files, licences and isotherm.pc. Each folder installs its own libraries, headers, programs and manuals.
install(DIRECTORY core/data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/isotherm
  FILES_MATCHING PATTERN "*.model" PATTERN "*.templates" PATTERN "*.metric")
install(FILES LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_file(cmake/isotherm.pc.in isotherm.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/isotherm.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
