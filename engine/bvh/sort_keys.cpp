#include "engine/bvh/sort_keys.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace zoe {

namespace {

constexpr int kDigitBits = 11, kDigits = 3;
constexpr size_t kBuckets = size_t{1} << kDigitBits;
constexpr size_t kSmall = 2048;

size_t digit(uint64_t key, int place) {
    return key >> (32 + place * kDigitBits) & (kBuckets - 1);
}

}  // namespace

void sort_keys(std::vector<uint64_t>* keys, std::vector<uint64_t>* scratch) {
    if (keys->size() <= kSmall) {
        std::sort(keys->begin(), keys->end());
        return;
    }
    std::array<std::array<uint32_t, kBuckets>, kDigits> places{};
    for (const uint64_t key : *keys) {
        for (int place = 0; place < kDigits; ++place) ++places[place][digit(key, place)];
    }
    scratch->resize(keys->size());
    for (int place = 0; place < kDigits; ++place) {
        uint32_t begin = 0;
        for (uint32_t& at : places[place]) {
            const uint32_t count = at;
            at = begin;
            begin += count;
        }
        for (const uint64_t key : *keys) (*scratch)[places[place][digit(key, place)]++] = key;
        keys->swap(*scratch);
    }
}

}  // namespace zoe
