# SPDX-License-Identifier: Apache-2.0
# The machine and its tools, nothing else: an aarch64 Linux, built on another machine against the
# folder that sysroot.sh makes (or AXG_JETSON_SYSROOT names) and tested under qemu. No -march: one
# build runs on every Jetson with an Orin or a Thor, and NEON is part of the architecture.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_SYSROOT "$ENV{AXG_JETSON_SYSROOT}")
if(NOT CMAKE_SYSROOT)
  get_filename_component(CMAKE_SYSROOT "${CMAKE_CURRENT_LIST_DIR}/../build/sysroot-arm64" ABSOLUTE)
endif()
if(NOT EXISTS "${CMAKE_SYSROOT}/usr/include")
  message(FATAL_ERROR "${CMAKE_SYSROOT}: no sysroot; run toolchains/sysroot.sh first")
endif()
if(NOT CMAKE_CXX_COMPILER)
  set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
  set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
endif()
if(CMAKE_CXX_COMPILER MATCHES "clang")  # one compiler for all machines
  string(REPLACE "clang++" "clang" CMAKE_C_COMPILER "${CMAKE_CXX_COMPILER}")
  set(CMAKE_C_COMPILER_TARGET aarch64-linux-gnu)
  set(CMAKE_CXX_COMPILER_TARGET aarch64-linux-gnu)
endif()
# nvcc runs here and links the runtime of there: the folder that cuda_toolkit.sh makes, or that of
# the nvcc which CMAKE_CUDA_COMPILER names. Without either, or with AXG_CUDA=OFF, everything but the
# CUDA engine is built: an nvcc for this machine alone cannot link for that one.
get_filename_component(toolkit "${CMAKE_CURRENT_LIST_DIR}/../build/cuda-aarch64" ABSOLUTE)
if(NOT CMAKE_CUDA_COMPILER)
  set(CMAKE_CUDA_COMPILER NOTFOUND)
  if(EXISTS "${toolkit}/version.txt")
    set(CMAKE_CUDA_COMPILER "${toolkit}/bin/nvcc")
  endif()
endif()
if(CMAKE_CUDA_COMPILER MATCHES "clang")  # CUDA 12.6 of jetpack6_toolkit.sh
  get_filename_component(toolkit "${CMAKE_CURRENT_LIST_DIR}/../build/cuda12-aarch64" ABSOLUTE)
  set(CUDAToolkit_ROOT "${toolkit}")
  set(CMAKE_CUDA_COMPILER_TARGET aarch64-linux-gnu)
  # By /lib it would name headers in a folder that is not there, and ninja build them each time.
  set(CMAKE_CUDA_COMPILER_EXTERNAL_TOOLCHAIN "${CMAKE_SYSROOT}/usr")
  set(CMAKE_CUDA_RUNTIME_LIBRARY None)  # PyPI has no static one of 12.6; the board has libcudart
  # What links libaxguard.so needs the runtime that it needs.
  string(APPEND CMAKE_EXE_LINKER_FLAGS_INIT " -Wl,-rpath-link,${toolkit}/lib")
  list(APPEND CMAKE_FIND_ROOT_PATH "${toolkit}")
elseif(CMAKE_CUDA_COMPILER)
  get_filename_component(toolkit "${CMAKE_CUDA_COMPILER}" DIRECTORY)
  get_filename_component(toolkit "${toolkit}" DIRECTORY)
  list(APPEND CMAKE_FIND_ROOT_PATH "${toolkit}")
endif()
set(CMAKE_CUDA_HOST_COMPILER "${CMAKE_CXX_COMPILER}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
find_program(AXG_QEMU NAMES qemu-aarch64 qemu-aarch64-static)
if(AXG_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${AXG_QEMU};-L;${CMAKE_SYSROOT}")
endif()
