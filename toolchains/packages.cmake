# SPDX-License-Identifier: Apache-2.0
# What is installed; a component is the Debian package of that name (debian/control). Each wants no
# more than Debian or a Jetson's Ubuntu has, and of CUDA what is on the board.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(AXG_INSTALL_DATA ${CMAKE_INSTALL_DATADIR}/axguard)

install(FILES firmware_if/axguard.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT libaxguard-dev)
install(TARGETS axguard axguard-certcheck RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
        COMPONENT axguard)
install(TARGETS axguard-lab RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT axguard-lab)
install(DIRECTORY config/machines DESTINATION ${AXG_INSTALL_DATA}/config COMPONENT axguard
        PATTERN README.md EXCLUDE)
install(DIRECTORY hil_replay/programs hil_replay/page DESTINATION ${AXG_INSTALL_DATA}/hil_replay
        COMPONENT axguard FILES_MATCHING PATTERN "*.ngc" PATTERN "*.html" PATTERN "*.css"
        PATTERN "*.js")
install(DIRECTORY hil_replay/plan DESTINATION ${AXG_INSTALL_DATA}/hil_replay COMPONENT axguard
        FILES_MATCHING PATTERN "*.py")
install(DIRECTORY hil_replay/lab/chart DESTINATION ${AXG_INSTALL_DATA}/hil_replay/lab
        COMPONENT axguard-lab FILES_MATCHING PATTERN "*.py")
# A machine without mesh files, to begin one's own with.
install(FILES config/machines/vice-mill.yaml RENAME sample.yaml
        DESTINATION ${CMAKE_INSTALL_FULL_SYSCONFDIR}/axguard COMPONENT axguardd)
install(FILES firmware_if/c_interface/example/guard_a_trace.c
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libaxguard-dev/examples COMPONENT libaxguard-dev)
# Firmware compiles the sources for its own processor; the library is for tests on this one.
install(TARGETS axg_firmware_if_board ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        COMPONENT axguard-board-dev)
install(DIRECTORY firmware_if/board/
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/axguard/firmware_if/board
        COMPONENT axguard-board-dev FILES_MATCHING PATTERN "axguard_*.h")
install(DIRECTORY firmware_if/board/ DESTINATION ${AXG_INSTALL_DATA}/board/firmware_if/board
        COMPONENT axguard-board-dev FILES_MATCHING PATTERN "*.h" PATTERN "*.c" PATTERN "misra.txt")
install(FILES tests/vectors/permit2.json tests/vectors/play_permit2.c
        DESTINATION ${AXG_INSTALL_DATA}/board/vectors COMPONENT axguard-board-dev)
if(AXG_STATIC_LIBRARIES AND TARGET meshoptimizer::meshoptimizer)
  # No static one is packaged: a copy goes into a folder of our own, which our files alone look in.
  get_target_property(name meshoptimizer::meshoptimizer IMPORTED_SONAME_NONE)
  install(FILES $<TARGET_FILE:meshoptimizer::meshoptimizer> RENAME ${name}
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/axguard COMPONENT libaxguard0)
  foreach(target axguard axguard-lab axguardd)
    set_target_properties(${target} PROPERTIES
      INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}/axguard")
  endforeach()
  set_target_properties(axg_c PROPERTIES INSTALL_RPATH "$ORIGIN/axguard")
endif()
if(AXG_SHARED)
  install(TARGETS axg_c EXPORT axguard INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libaxguard0
    NAMELINK_COMPONENT libaxguard-dev)
  install(EXPORT axguard NAMESPACE axguard:: FILE axguardTargets.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/axguard COMPONENT libaxguard-dev)
  set(AXG_GUARD axg_c_archive)
else()
  set(AXG_GUARD axg_c)
endif()

# One archive of the project's own libraries, for who links the guard in. What others wrote stays
# outside, but for the CUDA runtime and what AXG_STATIC_LIBRARIES names.
set(AXG_ARCHIVE ${PROJECT_BINARY_DIR}/packaged/libaxguard.a)
set(inside)
set(outside -lstdc++ -lm -lpthread -ldl -lrt)
axg_linked_rooms(rooms ${AXG_GUARD})
foreach(library ${AXG_GUARD} ${rooms})
  list(APPEND inside $<TARGET_FILE:${library}>)
endforeach()
if(AXG_CUDA_COMPILER)
  find_package(CUDAToolkit REQUIRED)
  if(AXG_CUDART STREQUAL "CUDA::cudart_static")
    list(APPEND inside $<TARGET_FILE:CUDA::cudart_static>)
  else()
    # Where NVIDIA's package puts it; the name of the -dev package's link is not needed.
    set(cuda_folder /usr/local/cuda-12.6/targets/aarch64-linux/lib)
    set(AXG_PC_VARIABLES "\ncudadir=${cuda_folder}")
    list(PREPEND outside "-L\${cudadir}" -l:libcudart.so.12)
  endif()
endif()
if(AXG_STATIC_LIBRARIES)
  list(APPEND inside ${AXG_YAML_CPP} ${AXG_MD_LIBRARY})
  # Found at run time too: no other file looks in that folder.
  list(PREPEND outside "-L\${libdir}/axguard" "-Wl,-rpath,\${libdir}/axguard"
    -l:libmeshoptimizer.so.2d)
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
# The pages of man, from the options and the files of the pages; the pages without links to what is
# not installed; and the changes as plain text.
find_package(Python3 COMPONENTS Interpreter)
set(AXG_PAGES ${PROJECT_BINARY_DIR}/packaged/pages)
set(manuals axguard axguardd axguard-lab)
list(TRANSFORM manuals REPLACE "(.+)" "${PROJECT_BINARY_DIR}/packaged/\\1.1" OUTPUT_VARIABLE pages)
list(APPEND pages ${PROJECT_BINARY_DIR}/packaged/axguard-certcheck.1)  # of the package axguard
file(GLOB_RECURSE sources CONFIGURE_DEPENDS docs/*)
add_custom_command(OUTPUT ${pages} ${PROJECT_BINARY_DIR}/packaged/changelog ${AXG_PAGES}/README.md
  DEPENDS toolchains/man_pages.py toolchains/install_pages.py README.md CHANGELOG.md ${sources}
  COMMAND Python3::Interpreter toolchains/man_pages.py ${PROJECT_VERSION}
          docs/reference/commands.md ${PROJECT_BINARY_DIR}/packaged
  COMMAND Python3::Interpreter toolchains/install_pages.py ${PROJECT_SOURCE_DIR} ${AXG_PAGES}
          --changelog ${PROJECT_BINARY_DIR}/packaged/changelog
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
foreach(name IN LISTS manuals)
  install(FILES ${PROJECT_BINARY_DIR}/packaged/${name}.1
          DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${name})
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/packaged/axguard-certcheck.1
        DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT axguard)
# A shell reads these when it first completes a word of the program, which then prints the rest: a
# cross build cannot run it.
foreach(name IN LISTS manuals)
  set(folder ${PROJECT_BINARY_DIR}/packaged/completion/${name})
  file(CONFIGURE OUTPUT ${folder}/${name} CONTENT "eval \"$(@name@ completion bash)\"\n" @ONLY)
  string(REPLACE "-" "_" function ${name})
  file(CONFIGURE OUTPUT ${folder}/_${name} @ONLY CONTENT
    "#compdef @name@\neval \"$(@name@ completion zsh)\"\n_@function@ \"$@\"\n")
  file(CONFIGURE OUTPUT ${folder}/${name}.fish CONTENT "@name@ completion fish | source\n" @ONLY)
  install(FILES ${folder}/${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          COMPONENT ${name})
  install(FILES ${folder}/_${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
          COMPONENT ${name})
  install(FILES ${folder}/${name}.fish
          DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT ${name})
endforeach()
install(DIRECTORY ${AXG_PAGES}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/axguard-doc/pages
        COMPONENT axguard-doc)
add_custom_target(packaged_pages DEPENDS ${pages})
add_custom_target(packaged DEPENDS axguard axguard-certcheck axguard-lab axguardd axg_c
  axg_firmware_if_board ${AXG_ARCHIVE})
add_dependencies(packaged packaged_pages)
if(TARGET axguard-hal)
  # Types of the pins from the sources, meanings from the page. Of each build: `cmake --install`
  # puts them where LinuxCNC looks.
  set(manuals ${PROJECT_BINARY_DIR}/packaged/axguard_stop.9
              ${PROJECT_BINARY_DIR}/packaged/axguard-hal.9)
  add_custom_command(OUTPUT ${manuals}
    DEPENDS toolchains/hal_man_pages.py toolchains/man_pages.py docs/reference/linuxcnc.md
            firmware_if/linuxcnc/axguard_pins.h firmware_if/linuxcnc/axguard_hal.c
    COMMAND Python3::Interpreter toolchains/hal_man_pages.py ${PROJECT_VERSION}
            ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/packaged
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  add_custom_target(packaged_hal_pages ALL DEPENDS ${manuals})
  install(FILES ${manuals} DESTINATION ${CMAKE_INSTALL_MANDIR}/man9 COMPONENT axguard-linuxcnc)
  add_dependencies(packaged axguard-hal axguard_stop packaged_hal_pages)
endif()
list(JOIN outside " " AXG_LIBRARIES_PRIVATE)
list(TRANSFORM outside REPLACE "[$]{libdir}" "\${AXGUARD_LIBRARIES}" OUTPUT_VARIABLE linked)
list(TRANSFORM linked REPLACE "[$]{cudadir}" "${cuda_folder}")
list(JOIN linked ";" AXG_LIBRARIES_CMAKE)
configure_file(toolchains/axguard.pc.in packaged/axguard.pc @ONLY)
configure_file(toolchains/axguardConfig.cmake.in packaged/axguardConfig.cmake @ONLY)
write_basic_package_version_file(packaged/axguardConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${AXG_ARCHIVE} DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libaxguard-dev)
install(FILES ${PROJECT_BINARY_DIR}/packaged/axguard.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT libaxguard-dev)
install(FILES ${PROJECT_BINARY_DIR}/packaged/axguardConfig.cmake
        ${PROJECT_BINARY_DIR}/packaged/axguardConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/axguard COMPONENT libaxguard-dev)

# make_sbom.py writes these when everything is built: what the programs contain, and its licences.
foreach(component axguard axguardd axguard-lab axguard-linuxcnc libaxguard0 libaxguard-dev
        axguard-board-dev)
  install(FILES ${PROJECT_BINARY_DIR}/packaged/sbom.spdx.json
          ${PROJECT_BINARY_DIR}/packaged/licences
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${component} COMPONENT ${component} OPTIONAL)
endforeach()
