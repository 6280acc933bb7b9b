// SPDX-License-Identifier: Apache-2.0
// Marks for arithmetic that g++, clang++ and nvcc all compile: callable on the device, and never
// emitted out of line, so that a copy compiled for one instruction set can not be linked in for
// another (tests/style/isa_symbols.py).
#pragma once

#if defined(__CUDACC__)
#define AXG_HD __host__ __device__ __forceinline__
#else
#define AXG_HD [[gnu::always_inline]] inline
#endif
