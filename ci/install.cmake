# What `cmake --install` and `cpack` take along. Nothing here names a folder of this machine: an installation works
# wherever its prefix is moved.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The program and its data; engine/scenario/find.cc finds these from the program's own place.
install(TARGETS dynoproof DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS dynoproof_fmu_slave LIBRARY DESTINATION lib/dynoproof)  # goes into each unit that `export --fmu` writes
install(DIRECTORY scenarios golden DESTINATION share/dynoproof PATTERN oracles EXCLUDE)
install(FILES reports/run.schema.json reports/probe.schema.json reports/reduce.schema.json reports/bisect.schema.json
        DESTINATION share/dynoproof)
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff ci/copyright DESTINATION share/doc/dynoproof)
install(DIRECTORY bench/campaigns DESTINATION share/doc/dynoproof/examples PATTERN blind.toml EXCLUDE)

# Manual pages and bash completion, from the help of the program that is installed.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
install(CODE "execute_process(COMMAND \"${Python3_EXECUTABLE}\" \"${PROJECT_SOURCE_DIR}/ci/manual.py\" \"$<TARGET_FILE:dynoproof>\" \"${PROJECT_BINARY_DIR}/manual\" COMMAND_ERROR_IS_FATAL ANY)")
install(DIRECTORY ${PROJECT_BINARY_DIR}/manual/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES ${PROJECT_BINARY_DIR}/manual/dynoproof DESTINATION share/bash-completion/completions)

# What a plugin of somebody else's needs: headers and libraries of base, linear, model and score, and what a check sees
# of a run.
foreach(layer base linear model score control10k)
  install(DIRECTORY engine/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/dynoproof FILES_MATCHING PATTERN "*.h")
endforeach()
install(FILES engine/experiment/check.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/dynoproof/experiment)
install(FILES ${PROJECT_BINARY_DIR}/generated/model/abi_stamp.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/dynoproof/model)
install(TARGETS dynoproof_base dynoproof_linear dynoproof_model dynoproof_score dynoproof_control10k EXPORT dynoproof DESTINATION ${CMAKE_INSTALL_LIBDIR}/dynoproof)
install(EXPORT dynoproof NAMESPACE dynoproof:: FILE dynoproofTargets.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/dynoproof)
file(WRITE ${PROJECT_BINARY_DIR}/dynoproofConfig.cmake
     "include(CMakeFindDependencyMacro)\nfind_dependency(Eigen3)\nfind_dependency(fmt)\n"
     "include(\${CMAKE_CURRENT_LIST_DIR}/dynoproofTargets.cmake)\n")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/dynoproofConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/dynoproofConfig.cmake ${PROJECT_BINARY_DIR}/dynoproofConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/dynoproof)

# The Debian package: `cpack --config build/CPackConfig.cmake`; ci/check_package.sh tries it in a clean system.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "dynoproof maintainers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "proves simulations of highly dynamic test beds")
set(CPACK_PACKAGE_DESCRIPTION
    "Runs declarative scenarios of drive lines, couplings and pressure systems with two solvers, scores each run against\n\
golden data, independent oracles and published figures, and says where and why a simulation disagrees with a record.\n\
The headers and libraries for plugins are part of the package.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
    WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, libeigen3-dev, libfmt-dev")  # to build plugins
include(CPack)
