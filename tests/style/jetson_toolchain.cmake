# SPDX-License-Identifier: Apache-2.0
# An nvcc that somebody names is the one that toolchains/aarch64-jetson.cmake takes, with the CUDA
# runtime beside it, whatever lies in build/. Run by: cmake -P
set(ENV{AXG_JETSON_SYSROOT} /)  # any root with headers: nothing is compiled
set(CMAKE_CUDA_COMPILER /elsewhere/cuda/bin/nvcc)
include(${CMAKE_CURRENT_LIST_DIR}/../../toolchains/aarch64-jetson.cmake)
if(NOT CMAKE_CUDA_COMPILER STREQUAL "/elsewhere/cuda/bin/nvcc")
  message(FATAL_ERROR "nvcc: got ${CMAKE_CUDA_COMPILER}, wanted /elsewhere/cuda/bin/nvcc")
endif()
if(NOT CMAKE_FIND_ROOT_PATH STREQUAL "/elsewhere/cuda")
  message(FATAL_ERROR "runtime: got ${CMAKE_FIND_ROOT_PATH}, wanted /elsewhere/cuda")
endif()
