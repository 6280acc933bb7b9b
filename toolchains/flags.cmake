# SPDX-License-Identifier: Apache-2.0
# Compiler flags in one place. Contraction is off everywhere: equal bits on every engine are a
# promise (docs/theory/accuracy.md).
add_library(axg_flags INTERFACE)
add_library(axg::flags ALIAS axg_flags)
target_compile_features(axg_flags INTERFACE cxx_std_20)
target_include_directories(axg_flags INTERFACE "${PROJECT_SOURCE_DIR}")
# nvcc has words of its own for these (cuda/CMakeLists.txt).
set(AXG_CXX_OPTIONS -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off
    -fno-fast-math $<$<BOOL:${AXG_WERROR}>:-Werror>)
target_compile_options(axg_flags INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:${AXG_CXX_OPTIONS}>")
# What is linked is what is called: a package wants no library that its programs never use.
target_link_options(axg_flags INTERFACE LINKER:--as-needed)
if(AXG_SHARED)  # the library's calls of itself are its own, and may be inlined as in a program
  target_compile_options(axg_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-fno-semantic-interposition>)
endif()
if(AXG_SANITIZE)
  set(AXG_SANITIZE_OPTIONS -fsanitize=${AXG_SANITIZE} -fno-sanitize-recover=all
      -fno-omit-frame-pointer)
  target_compile_options(axg_flags INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:${AXG_SANITIZE_OPTIONS}>")
  target_link_options(axg_flags INTERFACE -fsanitize=${AXG_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # takes its own checks for uses, in libstdc++ too
    target_compile_options(axg_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized>)
  endif()
endif()
# What reads options and writes text or JSON (rooms.cmake).
if(AXG_SANITIZE)
  set(AXG_TEXT_OPTIONS -O0)
else()
  set(AXG_TEXT_OPTIONS $<$<CONFIG:Release>:-O1>)
endif()
# None of these changes how a number is computed. What they cost:
# docs/measurements/machine-files.md. check_packages.py looks for each in the finished files.
if(AXG_HARDENING)
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES CXX)  # without it CMake does not link with -pie
  set(AXG_HARDENING_OPTIONS -fstack-protector-strong -fstack-clash-protection)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND AXG_HARDENING_OPTIONS -fcf-protection=full)
  elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
    list(APPEND AXG_HARDENING_OPTIONS -mbranch-protection=standard)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 12)
    set(AXG_FORTIFY_LEVEL 2)  # the highest that it knows
  else()
    set(AXG_FORTIFY_LEVEL 3)
  endif()
  if(CMAKE_BUILD_TYPE STREQUAL "Release")  # -U: the compilers of some systems define a lower level
    list(APPEND AXG_HARDENING_OPTIONS -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=${AXG_FORTIFY_LEVEL})
  endif()
  target_compile_options(axg_flags INTERFACE
    "$<$<COMPILE_LANGUAGE:CXX>:${AXG_HARDENING_OPTIONS}>")
  target_link_options(axg_flags INTERFACE LINKER:-z,relro LINKER:-z,now LINKER:-z,noexecstack)
endif()
