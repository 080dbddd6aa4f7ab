# The installed package: headers, two target files, and a config file. Every path is relative to the prefix, so that
# --prefix and DESTDIR both work at install time.

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(phimis_package_dir "${CMAKE_INSTALL_DATADIR}/cmake/phimis")

# Two exports: whoever takes only core must not meet the name of Eigen.
install(TARGETS phimis_core EXPORT phimis-core-targets FILE_SET HEADERS)
install(EXPORT phimis-core-targets NAMESPACE phimis:: DESTINATION "${phimis_package_dir}")
if(TARGET phimis_phimis)
  install(TARGETS phimis_phimis EXPORT phimis-targets FILE_SET HEADERS)
  install(EXPORT phimis-targets NAMESPACE phimis:: DESTINATION "${phimis_package_dir}")
endif()

configure_package_config_file(cmake/phimis-config.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/phimis-config.cmake"
                              INSTALL_DESTINATION "${phimis_package_dir}" NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/phimis-config-version.cmake"
                                 COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/phimis-config.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/phimis-config-version.cmake"
        DESTINATION "${phimis_package_dir}")
