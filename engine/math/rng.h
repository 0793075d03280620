#pragma once

#include <cstdint>

namespace zoe {

/// Mixes 64 bits into 64 well-spread bits (the finaliser of SplitMix64; Steele, Lea, Flood 2014).
inline uint64_t mix_bits(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// Pseudo-random numbers by counter: the n-th number of a seed, whoever asks and when.
class Rng {
public:
    explicit Rng(uint64_t seed) : state_(seed) {}
    uint64_t next() { return mix_bits(state_ += 0x9e3779b97f4a7c15ull); }
    /// Uniform in [0, 1), 24 bits.
    float uniform() { return static_cast<float>(next() >> 40) * 0x1p-24f; }
    float uniform(float lo, float hi) { return lo + (hi - lo) * uniform(); }
    uint32_t below(uint32_t n) { return static_cast<uint32_t>(((next() >> 32) * n) >> 32); }

private:
    uint64_t state_;
};

}  // namespace zoe
