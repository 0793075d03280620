#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/bvh/traverse.h"
#include "engine/math/simd_targets.h"

#include <hwy/targets.h>

namespace zoe::test {

/// Runs a body with each instruction set that this processor has and the kernels are compiled for.
template <typename Body>
void on_each_target(Body&& body) {
    std::vector<std::string> seen;
    for (const int64_t target : {HWY_EMU128, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
        hwy::SetSupportedTargetsForTest(0);
        if ((HWY_TARGETS & target) == 0 || (target != HWY_EMU128 && (hwy::SupportedTargets() & target) == 0)) continue;
        hwy::SetSupportedTargetsForTest(target);
        SCOPED_TRACE(simd_target());
        for (const std::string& other : seen) EXPECT_NE(other, simd_target());
        seen.emplace_back(simd_target());
        body();
    }
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_GE(seen.size(), 2u);
}

}  // namespace zoe::test
