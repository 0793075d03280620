#include "tests/support/gltf_container.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace zoe::test {
namespace {

std::vector<uint8_t> read_bytes(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error("oracle: cannot read " + file.string());
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

uint32_t little_endian(const std::vector<uint8_t>& bytes, size_t at) {
    if (at + 4 > bytes.size()) throw std::runtime_error("oracle: .glb ends too early");
    return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | static_cast<uint32_t>(bytes[at + 3]) << 24;
}

int base64_value(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;
    if (c == '/' || c == '_') return 63;
    return -1;
}

std::vector<uint8_t> decode_base64(const std::string& text, size_t begin) {
    std::vector<uint8_t> bytes;
    uint32_t bits = 0;
    int bit_count = 0;
    for (size_t i = begin; i < text.size() && text[i] != '='; ++i) {
        const int value = base64_value(text[i]);
        if (value < 0) throw std::runtime_error("oracle: not base64");
        bits = bits << 6 | static_cast<uint32_t>(value);
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes.push_back(static_cast<uint8_t>(bits >> bit_count & 0xff));
        }
    }
    return bytes;
}

std::string decode_percent(const std::string& uri) {
    std::string path;
    for (size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size()) {
            path.push_back(static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16)));
            i += 2;
        } else {
            path.push_back(uri[i]);
        }
    }
    return path;
}

}  // namespace

GltfContainer read_container(const std::filesystem::path& file) {
    constexpr uint32_t kGlb = 0x46546c67, kJson = 0x4e4f534a, kBin = 0x004e4942;
    std::vector<uint8_t> bytes = read_bytes(file);
    if (bytes.size() < 4 || little_endian(bytes, 0) != kGlb) return {std::string(bytes.begin(), bytes.end()), {}};

    GltfContainer container;
    const size_t end = little_endian(bytes, 8);
    for (size_t at = 12; at + 8 <= end;) {
        const size_t length = little_endian(bytes, at);
        const uint32_t kind = little_endian(bytes, at + 4);
        at += 8;
        if (length > bytes.size() - at) throw std::runtime_error("oracle: a chunk of the .glb is too long");
        const auto chunk = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        const auto chunk_end = chunk + static_cast<std::ptrdiff_t>(length);
        if (kind == kJson) container.json.assign(chunk, chunk_end);
        if (kind == kBin) container.binary.assign(chunk, chunk_end);
        at += length;
    }
    return container;
}

std::vector<uint8_t> read_uri(const std::filesystem::path& folder, const std::string& uri) {
    if (!uri.starts_with("data:")) return read_bytes(folder / std::filesystem::path(decode_percent(uri)));
    const std::string marker = ";base64,";
    const size_t at = uri.find(marker);
    if (at == std::string::npos) throw std::runtime_error("oracle: a data URI without base64");
    return decode_base64(uri, at + marker.size());
}

}  // namespace zoe::test
