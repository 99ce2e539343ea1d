# Data files, licences and isotherm.pc. Each folder installs its own libraries, headers, programs and manuals.
install(DIRECTORY core/data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/isotherm
  FILES_MATCHING PATTERN "*.model" PATTERN "*.templates" PATTERN "*.metric")
# Stored frames of two rendered people, with which `isothermd --judge` checks recognition.
foreach(stored p01-v2:enrolled p02-v1:other p01-v1:visitor)
  string(REPLACE ":" ";" stored ${stored})
  list(GET stored 0 recording)
  list(GET stored 1 name)
  install(DIRECTORY sim/stored/${recording}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/isotherm/judge/${name}
    PATTERN landmarks.csv EXCLUDE)
endforeach()
install(FILES LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_file(cmake/isotherm.pc.in isotherm.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/isotherm.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
