# SPDX-License-Identifier: Apache-2.0
# A compiler of kernels that somebody names is what toolchains/aarch64-jetson.cmake takes: an nvcc
# with the CUDA runtime beside it, clang with the folder of JetPack 6, whatever else lies in build/.
# Run by: cmake -P
set(ENV{AXG_JETSON_SYSROOT} /)  # any root with headers: nothing is compiled
set(CMAKE_CUDA_COMPILER /elsewhere/cuda/bin/nvcc)
include(${CMAKE_CURRENT_LIST_DIR}/../../toolchains/aarch64-jetson.cmake)
if(NOT CMAKE_CUDA_COMPILER STREQUAL "/elsewhere/cuda/bin/nvcc")
  message(FATAL_ERROR "nvcc: got ${CMAKE_CUDA_COMPILER}, wanted /elsewhere/cuda/bin/nvcc")
endif()
if(NOT CMAKE_FIND_ROOT_PATH STREQUAL "/elsewhere/cuda")
  message(FATAL_ERROR "runtime: got ${CMAKE_FIND_ROOT_PATH}, wanted /elsewhere/cuda")
endif()
set(CMAKE_CUDA_COMPILER clang++-19)
set(CMAKE_FIND_ROOT_PATH)
include(${CMAKE_CURRENT_LIST_DIR}/../../toolchains/aarch64-jetson.cmake)
if(NOT CUDAToolkit_ROOT MATCHES "/build/cuda12-aarch64$" OR
   NOT CMAKE_FIND_ROOT_PATH STREQUAL CUDAToolkit_ROOT)
  message(FATAL_ERROR "JetPack 6: got ${CUDAToolkit_ROOT} and ${CMAKE_FIND_ROOT_PATH}")
endif()
if(NOT CMAKE_CUDA_COMPILER_TARGET STREQUAL "aarch64-linux-gnu")
  message(FATAL_ERROR "clang: for ${CMAKE_CUDA_COMPILER_TARGET}, wanted aarch64-linux-gnu")
endif()
