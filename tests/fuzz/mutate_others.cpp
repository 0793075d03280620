#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "tests/fuzz/entries.h"
#include "tests/fuzz/mutate.h"

namespace zoe::test {
namespace {

uint32_t crc32(std::string_view bytes) {
    static const std::array<uint32_t, 256> table = [] {
        std::array<uint32_t, 256> made{};
        for (uint32_t i = 0; i < 256; ++i) {
            made[i] = i;
            for (int bit = 0; bit < 8; ++bit) made[i] = (made[i] & 1u) != 0 ? 0xedb88320u ^ made[i] >> 1 : made[i] >> 1;
        }
        return made;
    }();
    uint32_t crc = ~0u;
    for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xffu] ^ crc >> 8;
    return ~crc;
}

uint32_t read_big_endian(const std::string& bytes, size_t at) {
    uint32_t value = 0;
    for (size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
}

void put_big_endian(std::string& bytes, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift & 0xffu));
}

constexpr size_t kSignatureSize = 8;

/// Type and data of each chunk.
std::vector<std::string> split_png(const std::string& png) {
    std::vector<std::string> chunks;
    for (size_t at = kSignatureSize; at + 12 <= png.size();) {
        const size_t length = read_big_endian(png, at);
        if (length > png.size() - at - 12) break;
        chunks.push_back(png.substr(at + 4, 4 + length));
        at += 12 + length;
    }
    return chunks;
}

void change_chunk(std::string& chunk, std::span<const std::string> others, Rng& rng) {
    if (chunk.starts_with("IHDR") && chunk.size() == 17 && rng.below(2) == 0) {
        constexpr uint32_t kSizes[] = {0, 1, 7, 8, 9, 1000, 16384, 16385, 65000, 0x7fffffff, 0x80000000, 0xffffffff};
        if (rng.below(2) == 0) {
            std::string size;
            put_big_endian(size, pick(kSizes, rng));
            chunk.replace(rng.below(2) == 0 ? 4 : 8, 4, size);
        } else {  // Depth, colours, methods, interlacing.
            constexpr char kSmall[] = {0, 1, 2, 3, 4, 6, 8, 16, 32};
            chunk[12 + rng.below(5)] = pick(kSmall, rng);
        }
        return;
    }
    std::string data = chunk.substr(4);
    mutate_bytes(data, others, rng);
    chunk.replace(4, std::string::npos, data);
}

}  // namespace

void mutate_image(std::string& file, std::span<const std::string> others, Rng& rng) {
    if (!file.starts_with("\x89PNG") || rng.below(16) == 0) return mutate_bytes(file, others, rng);
    const std::string signature = file.substr(0, kSignatureSize);
    std::vector<std::string> chunks = split_png(file);
    for (uint32_t left = 1 + rng.below(3); left > 0 && !chunks.empty(); --left) {
        const size_t at = rng.below(static_cast<uint32_t>(chunks.size()));
        switch (rng.below(8)) {
            case 0:
                chunks.erase(chunks.begin() + static_cast<ptrdiff_t>(at));
                break;
            case 1:
                chunks.push_back(chunks[at]);
                break;
            case 2:
                std::swap(chunks[at], chunks[rng.below(static_cast<uint32_t>(chunks.size()))]);
                break;
            case 3: {  // A kind that pictures of this kind do not have.
                const std::string_view kinds[] = {"PLTE", "tRNS", "gAMA", "iCCP", "sRGB", "zTXt", "tEXt", "iTXt",
                                                  "pHYs", "oFFs", "sCAL", "hIST", "sPLT", "eXIf", "cHRM", "bKGD"};
                chunks.insert(chunks.begin() + static_cast<ptrdiff_t>(at),
                              std::string(pick(kinds, rng)) + chunks[at].substr(4));
                break;
            }
            default:
                change_chunk(chunks[at], others, rng);
        }
    }
    file = signature;
    for (const std::string& chunk : chunks) {
        put_big_endian(file, static_cast<uint32_t>(chunk.size() - 4));
        file += chunk;
        put_big_endian(file, crc32(chunk) ^ (rng.below(64) == 0 ? 1u : 0u));
    }
}

void mutate_tree(std::string& file, std::span<const std::string> others, Rng& rng) {
    if (file.size() < 5 || rng.below(16) == 0) return mutate_bytes(file, others, rng);
    constexpr uint32_t kWords[] = {0,          1,          2,          3,          7,          39,
                                   40,         119,        120,        0x7f800000, 0x7fc00000, 0xff800000,
                                   0x80000000, 0x80000001, 0xffffffff, 0x7fffffff, 0x3f800000, 0xbf800000};
    const uint32_t word_count = static_cast<uint32_t>((file.size() - 1) / 4);
    for (uint32_t left = 1 + rng.below(3); left > 0; --left) {
        const size_t at = 1 + 4 * size_t{rng.below(word_count)};
        uint32_t word = static_cast<uint32_t>(rng.next());
        if (rng.below(2) == 0) word = pick(kWords, rng);
        if (rng.below(4) == 0) std::memcpy(&word, &file[1 + 4 * size_t{rng.below(word_count)}], sizeof word);
        std::memcpy(&file[at], &word, sizeof word);
    }
    if (rng.below(64) == 0) mutate_bytes(file, others, rng);
    if (rng.below(8) != 0 && !file.empty()) file[0] = static_cast<char>(static_cast<unsigned char>(file[0]) | kSealBit);
}

}  // namespace zoe::test
