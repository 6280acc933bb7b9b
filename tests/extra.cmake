# SPDX-License-Identifier: Apache-2.0
# What is no single test program: rules of style, fuzz targets, benchmarks beside other libraries.
option(AXG_FUZZ "Build the fuzz targets (needs clang's libFuzzer; preset host-fuzz)" OFF)

foreach(folder support style oracle device fuzz benchmarks)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt)
    add_subdirectory(${folder})
  endif()
endforeach()
