# SPDX-License-Identifier: Apache-2.0
# What is installed, and the Debian packages made of it: axguard-runtime (the guard, its service,
# the C library), axguard-dev (header, CMake and pkg-config files) and axguard-tools (the workbench,
# its example machines and programs, the pages), and axguard-board-dev (what firmware of a motion
# board is made with). Each wants no more than Debian or a Jetson's Ubuntu
# has, and nothing of CUDA but the driver that is on the board.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(AXG_INSTALL_DATA ${CMAKE_INSTALL_DATADIR}/axguard)

# The header keeps its place below the folder that is named, as in this source tree.
install(FILES firmware_if/axguard.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/axguard/firmware_if
        COMPONENT dev)
install(TARGETS axguard axguard-lab RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
install(DIRECTORY config/machines DESTINATION ${AXG_INSTALL_DATA}/config COMPONENT tools
        PATTERN generator EXCLUDE)
install(DIRECTORY hil_replay/programs hil_replay/page DESTINATION ${AXG_INSTALL_DATA}/hil_replay
        COMPONENT tools FILES_MATCHING PATTERN "*.ngc" PATTERN "*.html" PATTERN "*.css"
        PATTERN "*.js")
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}-tools COMPONENT tools
        FILES_MATCHING PATTERN "*.md")
install(FILES firmware_if/c_interface/example/guard_a_trace.c
        DESTINATION ${CMAKE_INSTALL_DOCDIR}-dev/example COMPONENT dev)
# Firmware compiles the sources for its own processor; the library is for tests on this one.
install(TARGETS axg_firmware_if_board ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        COMPONENT board-dev)
install(DIRECTORY firmware_if/board/
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/axguard/firmware_if/board
        COMPONENT board-dev FILES_MATCHING PATTERN "axguard_*.h")
install(DIRECTORY firmware_if/board/ DESTINATION ${AXG_INSTALL_DATA}/board/firmware_if/board
        COMPONENT board-dev FILES_MATCHING PATTERN "*.h" PATTERN "*.c" PATTERN "misra.txt")
install(FILES tests/vectors/permit2.json tests/vectors/play_permit2.c tests/vectors/README.md
        DESTINATION ${AXG_INSTALL_DATA}/board/vectors COMPONENT board-dev)
install(FILES docs/reference/board.md docs/reference/protocol.md
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/axguard-board-dev
        COMPONENT board-dev)
if(AXG_STATIC_LIBRARIES AND TARGET meshoptimizer::meshoptimizer)
  # No static one is packaged: a copy goes into a folder of our own, which our files alone look in.
  get_target_property(name meshoptimizer::meshoptimizer IMPORTED_SONAME_NONE)
  install(FILES $<TARGET_FILE:meshoptimizer::meshoptimizer> RENAME ${name}
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/axguard COMPONENT runtime)
  foreach(target axguard axguard-lab axguardd)
    set_target_properties(${target} PROPERTIES
      INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}/axguard")
  endforeach()
  set_target_properties(axg_c PROPERTIES INSTALL_RPATH "$ORIGIN/axguard")
endif()
if(AXG_SHARED)
  install(TARGETS axg_c EXPORT axguard
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev)
  install(EXPORT axguard NAMESPACE axguard:: FILE axguardTargets.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/axguard COMPONENT dev)
  set(AXG_GUARD axg_c_archive)
else()
  set(AXG_GUARD axg_c)
endif()

# One archive of the project's own libraries, for who links the guard in. What others wrote stays
# outside, but for the CUDA runtime and what AXG_STATIC_LIBRARIES names.
set(AXG_ARCHIVE ${PROJECT_BINARY_DIR}/packaged/libaxguard.a)
set(inside)
set(outside -lstdc++ -lm -lpthread -ldl -lrt)
set(rooms firmware_if_setup firmware_if_guard firmware_if_receiver firmware_if_protocol
    firmware_if_can config_compiled config_machine config_mesh config_can config_text cuda_bench
    cuda_engine core_guard core_certificate core_collision core_machine core_mesh core_base)
list(TRANSFORM rooms PREPEND axg_)
foreach(library ${AXG_GUARD} ${rooms})
  list(APPEND inside $<TARGET_FILE:${library}>)
endforeach()
if(AXG_CUDA_COMPILER)
  find_package(CUDAToolkit REQUIRED)
  list(APPEND inside $<TARGET_FILE:CUDA::cudart_static>)
endif()
if(AXG_STATIC_LIBRARIES)
  list(APPEND inside ${AXG_YAML_CPP} ${AXG_MD_LIBRARY})
  list(PREPEND outside -L\\\${libdir}/axguard -l:libmeshoptimizer.so.2d)
else()
  list(PREPEND outside -lyaml-cpp -lfmt -lmd -lmeshoptimizer)
endif()
list(JOIN inside "\naddlib " script)
file(GENERATE OUTPUT ${AXG_ARCHIVE}.mri
  CONTENT "create ${AXG_ARCHIVE}\naddlib ${script}\nsave\n")
add_custom_command(OUTPUT ${AXG_ARCHIVE} DEPENDS ${AXG_GUARD} ${rooms} ${AXG_ARCHIVE}.mri
  COMMAND ${CMAKE_COMMAND} -E rm -f ${AXG_ARCHIVE}
  COMMAND ${CMAKE_AR} -M < ${AXG_ARCHIVE}.mri
  COMMAND ${CMAKE_STRIP} --strip-debug ${AXG_ARCHIVE})
add_custom_target(packaged DEPENDS axguard axguard-lab axguardd axg_c axg_firmware_if_board
  ${AXG_ARCHIVE})
list(JOIN outside " " AXG_LIBRARIES_PRIVATE)
list(TRANSFORM outside REPLACE "^-L.*libdir}" "-L\${AXGUARD_LIBRARIES}" OUTPUT_VARIABLE linked)
list(JOIN linked ";" AXG_LIBRARIES_CMAKE)
configure_file(toolchains/axguard.pc.in packaged/axguard.pc @ONLY)
configure_file(toolchains/axguardConfig.cmake.in packaged/axguardConfig.cmake @ONLY)
write_basic_package_version_file(packaged/axguardConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${AXG_ARCHIVE} DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/packaged/axguard.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/packaged/axguardConfig.cmake
        ${PROJECT_BINARY_DIR}/packaged/axguardConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/axguard COMPONENT dev)

# Every package says what it is, under which licences, and what it was linked with.
foreach(component runtime dev tools board-dev)
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/axguard-${component})
  install(FILES CHANGELOG.md DESTINATION ${folder} RENAME changelog.md COMPONENT ${component})
  install(FILES LICENSE DESTINATION ${folder} RENAME copyright COMPONENT ${component})
  # make_sbom.py writes it when everything is built.
  install(FILES ${PROJECT_BINARY_DIR}/packaged/sbom.spdx.json DESTINATION ${folder}
          COMPONENT ${component} OPTIONAL)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME axguard)
set(CPACK_PACKAGE_CONTACT "axguard developers <axguard@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime dev tools board-dev)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_BOARD-DEV_PACKAGE_SECTION libdevel)
foreach(component runtime dev tools board-dev)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME axguard-${component})
endforeach()
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
    "Collision guard for five-axis machine tools: axguardd, its service and the C library")
set(CPACK_COMPONENT_DEV_DESCRIPTION
    "Collision guard for five-axis machine tools: header, CMake and pkg-config files")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
    "Collision guard for five-axis machine tools: the workbench axguard, examples and pages")
set(CPACK_COMPONENT_BOARD-DEV_DESCRIPTION
    "Collision guard for five-axis machine tools: the board's side of the permit, for firmware")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "axguard-runtime (= ${PROJECT_VERSION})")
# What libaxguard.a links.
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS
    "g++, libyaml-cpp-dev, libfmt-dev, libmd-dev, libmeshoptimizer-dev")
# What the page of a report is made of, which axguard demo writes too.
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "libjs-three, libjs-dygraphs")
if(CMAKE_CROSSCOMPILING)
  # dpkg-shlibdeps knows only libraries that dpkg installed. These are what is left to be found at
  # run time, with the oldest release whose symbols suffice; check_packages.py compares.
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  set(depends "libc6 (>= 2.34), libgcc-s1 (>= 4.2), libstdc++6 (>= 11)")
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "${depends}")
  string(APPEND CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS
         ", axguard-runtime (= ${PROJECT_VERSION}), ${depends}")
  if(AXG_HAS_GMP)  # the exact judge of axguard-lab chart
    string(APPEND CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS ", libgmp10")
  endif()
else()
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
endif()
include(CPack)
