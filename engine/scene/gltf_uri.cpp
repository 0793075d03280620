#include "engine/scene/gltf_uri.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace zoe {
namespace {

namespace fs = std::filesystem;

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;
    if (c == '/' || c == '_') return 63;
    return -1;
}

bool has_scheme(const std::string& uri) {
    const size_t colon = uri.find(':');
    return colon != std::string::npos && colon > 0 && uri.find('/') > colon &&
           std::all_of(uri.begin(), uri.begin() + static_cast<ptrdiff_t>(colon),
                       [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '-' || c == '.'; });
}

std::vector<std::byte> read_data_uri(const std::string& uri) {
    const size_t comma = uri.find(',');
    if (comma == std::string::npos) throw std::runtime_error("a data URI without a comma");
    if (std::string_view(uri).substr(0, comma).find(";base64") == std::string_view::npos) {
        throw std::runtime_error("a data URI that is not base64");
    }
    std::vector<std::byte> bytes;
    if (!decode_base64(std::string_view(uri).substr(comma + 1), &bytes)) throw std::runtime_error("malformed base64");
    return bytes;
}

}  // namespace

std::vector<std::byte> read_whole_file(const fs::path& file, uint64_t max_bytes) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) throw std::runtime_error("there is no such file");
    if (fs::is_directory(status)) throw std::runtime_error("it is a directory");
    if (!fs::is_regular_file(status)) throw std::runtime_error("it is not a regular file");
    const uint64_t size = fs::file_size(file, error);
    if (error) throw std::runtime_error(error.message());
    if (size > max_bytes) throw std::runtime_error("it has more than " + std::to_string(max_bytes) + " bytes");
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error(std::string("it cannot be opened: ") + std::strerror(errno));
    std::vector<std::byte> bytes(size);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (static_cast<uint64_t>(in.gcount()) != size) throw std::runtime_error("it cannot be read to its end");
    return bytes;
}

bool decode_percent(std::string_view text, std::string* out) {
    out->clear();
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            out->push_back(text[i]);
            continue;
        }
        if (i + 2 >= text.size()) return false;
        const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
        if (high < 0 || low < 0 || (high == 0 && low == 0)) return false;
        out->push_back(static_cast<char>(high * 16 + low));
        i += 2;
    }
    return true;
}

bool decode_base64(std::string_view text, std::vector<std::byte>* out) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    if (text.size() % 4 == 1) return false;
    out->clear();
    out->reserve(text.size() / 4 * 3 + 2);
    uint32_t bits = 0;
    int bit_count = 0;
    for (const char c : text) {
        const int digit = base64_digit(c);
        if (digit < 0) return false;
        bits = bits << 6 | static_cast<uint32_t>(digit);
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            out->push_back(static_cast<std::byte>(bits >> bit_count & 0xffu));
        }
    }
    return true;
}

fs::path find_uri_file(const std::string& uri, const fs::path& folder) {
    if (uri.empty()) throw std::runtime_error("an empty URI");
    if (has_scheme(uri)) throw std::runtime_error("only files beside the scene and data URIs are read");
    std::string decoded;
    if (!decode_percent(uri, &decoded)) decoded = uri;  // Exporters write plain file names with a % in them, too.
    if (decoded.find('\0') != std::string::npos) throw std::runtime_error("a file name with a zero byte");
    const fs::path relative(decoded);
    const bool climbs = std::find(relative.begin(), relative.end(), "..") != relative.end();
    if (relative.is_absolute() || climbs) throw std::runtime_error("the path leaves the scene's folder");

    // A link may leave the folder where the text does not.
    std::error_code error;
    const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
    if (error) throw std::runtime_error(error.message());
    const fs::path target = fs::canonical(root / relative, error);
    if (error) throw std::runtime_error("there is no such file");
    if (std::mismatch(root.begin(), root.end(), target.begin(), target.end()).first != root.end()) {
        throw std::runtime_error("the path leaves the scene's folder");
    }
    return target;
}

std::vector<std::byte> read_uri(const std::string& uri, const fs::path& folder, uint64_t max_bytes) {
    if (uri.starts_with("data:")) return read_data_uri(uri);
    return read_whole_file(find_uri_file(uri, folder), max_bytes);
}

std::string shown(const std::string& uri) {
    if (uri.starts_with("data:")) return "data URI";
    return uri.size() > 100 ? uri.substr(0, 100) + "..." : uri;
}

}  // namespace zoe
