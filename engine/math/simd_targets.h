#pragma once

// What Highway compiles for. Stands before its headers.

// Processors without any vectors run an emulation of them: the compiler error that keeps Highway from it by default
// (GCC 106322) is one of integer products, of which there are none here.
#define HWY_BROKEN_EMU128 0
// Not compiled: targets that differ from the next older one only in what is not used here, and vectors of no fixed size.
#define ZOETROPE_UNUSED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// Under g++'s sanitizers each target takes minutes to compile: those of four lanes and of eight find what all would.
#define HWY_DISABLED_TARGETS (ZOETROPE_UNUSED_TARGETS | HWY_AVX3)
#else
#define HWY_DISABLED_TARGETS ZOETROPE_UNUSED_TARGETS
#endif
