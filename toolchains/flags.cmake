# SPDX-License-Identifier: Apache-2.0
# Compiler flags in one place. Contraction is off everywhere: equal bits on every engine are a
# promise (docs/accuracy.md).
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
