# SPDX-License-Identifier: Apache-2.0
# What is no single test program: rules of style, fuzz targets, benchmarks beside other libraries.
option(AXG_FUZZ "Build the fuzz targets (needs clang's libFuzzer; preset host-asan)" OFF)

foreach(folder support style vectors oracle device parity model mutants fuzz benchmarks can_vm
        browser linuxcnc fresh)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt)
    add_subdirectory(${folder})
  endif()
endforeach()

if(CMAKE_CROSSCOMPILING)
  axg_emulated_tests()
endif()

add_test(NAME replay.new_machine COMMAND ${CMAKE_CURRENT_LIST_DIR}/tools/new_machine.sh
         ${PROJECT_BINARY_DIR})
set_tests_properties(replay.new_machine PROPERTIES LABELS "replay;data" TIMEOUT 300
  SKIP_RETURN_CODE ${AXG_SKIPPED_RETURN_CODE} ENVIRONMENT "AXG_SHARED_DATA=${AXG_SHARED_DATA}")
