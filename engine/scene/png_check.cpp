#include "engine/scene/png_check.h"

#include <array>
#include <cstdint>

namespace zoe {
namespace {

constexpr std::array<uint32_t, 256> make_crc_table() {
    std::array<uint32_t, 256> table{};
    for (uint32_t i = 0; i < 256; ++i) {
        uint32_t remainder = i;
        for (int bit = 0; bit < 8; ++bit) remainder = remainder >> 1 ^ (remainder & 1 ? 0xEDB88320u : 0u);
        table[i] = remainder;
    }
    return table;
}

uint32_t crc32(std::span<const std::byte> bytes) {
    static constexpr std::array<uint32_t, 256> kTable = make_crc_table();
    uint32_t crc = 0xffffffffu;
    for (const std::byte b : bytes) crc = crc >> 8 ^ kTable[(crc ^ std::to_integer<uint32_t>(b)) & 0xff];
    return ~crc;
}

uint32_t read_big_endian(std::span<const std::byte> bytes, size_t offset) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<uint32_t>(bytes[offset + i]);
    return value;
}

}  // namespace

bool is_whole_png(std::span<const std::byte> bytes) {
    constexpr uint32_t kIend = 0x49454E44;
    size_t offset = 8;  // The signature.
    while (bytes.size() >= offset + 12) {
        const size_t length = read_big_endian(bytes, offset);
        if (length > bytes.size() - offset - 12) return false;
        if (crc32(bytes.subspan(offset + 4, length + 4)) != read_big_endian(bytes, offset + 8 + length)) return false;
        if (read_big_endian(bytes, offset + 4) == kIend) return true;
        offset += length + 12;
    }
    return false;
}

}  // namespace zoe
