#include <algorithm>
#include <cstdint>
#include <cstring>

#include "tests/fuzz/mutate.h"

namespace zoe::test {
namespace {

// Limits of types, what is not finite, tiny, or huge, and small numbers.
constexpr uint32_t kWords[] = {0,          1,          2,          3,          0xff,       0xffff,     0x10000,
                               0x7fffffff, 0x80000000, 0xffffffff, 0xfffffffe, 0x7f800000, 0xff800000, 0x7fc00000,
                               0x7f7fffff, 0x00000001, 0x00800000, 0x3f800000, 0xbf800000, 0x5e000000, 0x1e000000};

void change(std::string& bytes, std::span<const std::string> others, Rng& rng) {
    if (bytes.empty()) bytes = pick(others, rng);
    if (bytes.empty()) return;
    const size_t at = position_in(bytes, rng);
    const size_t length = std::min<size_t>(bytes.size() - at, 1 + rng.below(rng.below(8) == 0 ? 4000 : 16));
    switch (rng.below(10)) {
        case 0:
            bytes[at] = static_cast<char>(bytes[at] ^ 1 << rng.below(8));
            break;
        case 1:
            bytes[at] = static_cast<char>(rng.below(256));
            break;
        case 2:
        case 3:
        case 4: {
            const uint32_t word = rng.below(4) == 0 ? static_cast<uint32_t>(rng.next()) : pick(kWords, rng);
            const size_t aligned = rng.below(4) == 0 ? at : at / 4 * 4;
            std::memcpy(&bytes[aligned], &word, std::min<size_t>(sizeof word, bytes.size() - aligned));
            break;
        }
        case 5:
            bytes.erase(at, length);
            break;
        case 6:
            bytes.insert(position_in(bytes, rng), bytes.substr(at, length));
            break;
        case 7:
            bytes.resize(at);
            break;
        case 8: {
            const std::string& other = pick(others, rng);
            if (other.empty()) break;
            const size_t from = position_in(other, rng);
            bytes.replace(at, rng.below(2) == 0 ? length : 0, other.substr(from, length));
            break;
        }
        default:
            std::swap(bytes[at], bytes[position_in(bytes, rng)]);
    }
}

}  // namespace

void mutate_bytes(std::string& bytes, std::span<const std::string> others, Rng& rng) {
    for (uint32_t left = 1 + rng.below(4); left > 0; --left) change(bytes, others, rng);
}

}  // namespace zoe::test
