# SPDX-License-Identifier: Apache-2.0
# Looks for nvcc. AXG_CUDA_COMPILER says whether the CUDA engine is built, and
# AXG_CUDA_ARCHITECTURES for which devices: Turing and up on a PC, both Orins (87), the H100 and
# H200 (90), Thor (110), each as far as the compiler knows it. Machine code only: nothing is
# compiled when the guard starts.
option(AXG_CUDA "Build the CUDA engine where nvcc is found" ON)
set(AXG_CUDA_COMPILER OFF)
if(AXG_CUDA)
  include(CheckLanguage)
  # setup.sh --all puts one there where none is installed.
  find_program(AXG_NVCC nvcc PATHS /usr/local/cuda/bin
               "${PROJECT_SOURCE_DIR}/build/cuda-${CMAKE_HOST_SYSTEM_PROCESSOR}/bin")
  if(AXG_NVCC AND NOT DEFINED ENV{CUDACXX})
    set(ENV{CUDACXX} "${AXG_NVCC}")
  endif()
  check_language(CUDA)
  if(CMAKE_CUDA_COMPILER)
    set(CMAKE_CUDA_ARCHITECTURES OFF)
    enable_language(CUDA)
    set(AXG_CUDA_COMPILER ON)
    set(AXG_CUDART CUDA::cudart_static)
    if(CMAKE_CUDA_COMPILER_ID STREQUAL "Clang")  # the preset names the device
      set(AXG_CUDART CUDA::cudart)
      set(known "")
    else()
      execute_process(COMMAND ${CMAKE_CUDA_COMPILER} --list-gpu-arch OUTPUT_VARIABLE known)
    endif()
    set(architectures)
    foreach(number 75 87 90 110)
      if(known MATCHES "compute_${number}\n")
        list(APPEND architectures ${number}-real)
      endif()
    endforeach()
    set(AXG_CUDA_KNOWN_ARCHITECTURES ${architectures})
    set(AXG_CUDA_ARCHITECTURES "${architectures}" CACHE STRING "Devices the CUDA engine is for")
  else()
    message(STATUS "No CUDA compiler: everything but the CUDA engine is built")
  endif()
endif()
