# SPDX-License-Identifier: Apache-2.0
# The libraries that others wrote. AXG_STATIC_LIBRARIES links in those whose file names change from
# one release of a distribution to the next, so that one package serves them all: a Jetson's Ubuntu
# has none of this Debian's. What has no static library here, meshoptimizer, is then packed beside
# the programs (packages.cmake).
option(AXG_STATIC_LIBRARIES "Link in yaml-cpp, fmt, libmd and zlib" OFF)
# Where bits decide nothing that is compared between machines (docs/decisions/own-types.md): one way
# of adding on every processor.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
add_library(axg_eigen INTERFACE)
target_link_libraries(axg_eigen INTERFACE Eigen3::Eigen)
target_compile_definitions(axg_eigen INTERFACE EIGEN_DONT_VECTORIZE)
find_package(yaml-cpp REQUIRED)
find_package(fmt REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(Threads REQUIRED)
set(AXG_FMT fmt::fmt)
set(AXG_YAML_CPP yaml-cpp)
set(AXG_MD_NAMES md)
if(AXG_STATIC_LIBRARIES)
  set(AXG_FMT fmt::fmt-header-only)
  find_library(AXG_YAML_CPP_LIBRARY libyaml-cpp.a REQUIRED)
  set(AXG_YAML_CPP ${AXG_YAML_CPP_LIBRARY})
  set(AXG_MD_NAMES libmd.a)
  set(ZLIB_USE_STATIC_LIBS ON)
endif()
find_path(AXG_MD_INCLUDE_DIR sha2.h REQUIRED)  # libmd: SHA-256 of pinned meshes
find_library(AXG_MD_LIBRARY NAMES ${AXG_MD_NAMES} REQUIRED)
find_package(ZLIB)  # without it compressed traces are refused, with a word on what to do
find_package(meshoptimizer QUIET)  # without it a machine file's simplify_mm is refused
if(NOT AXG_STATIC_LIBRARIES)
  find_package(tinyxml2 QUIET)  # without it axguard init --urdf is refused; no static one exists
endif()
find_path(AXG_MICROHTTPD_INCLUDE_DIR microhttpd.h)  # without it axguard watch is refused
find_library(AXG_MICROHTTPD_LIBRARY NAMES microhttpd)
