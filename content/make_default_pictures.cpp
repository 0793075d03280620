#include <array>
#include <cmath>

#include "content/make_default_parts.h"

namespace zoe {
namespace {

/// A picture of at most 16 colours, 4 bits a pixel.
struct Palette {
    std::vector<uint32_t> colors;  // 0xRRGGBB
    int width = 0, height = 0;
    std::vector<uint8_t> pixels;  // [height * width] positions in `colors`.
};

uint32_t crc(const uint8_t* bytes, size_t count) {
    uint32_t c = 0xffffffffu;
    for (size_t i = 0; i < count; ++i) {
        c ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) c = (c >> 1) ^ (c & 1 ? 0xedb88320u : 0u);
    }
    return ~c;
}

void put32(std::vector<uint8_t>& out, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(value >> shift));
}

void put_chunk(std::vector<uint8_t>& out, const char* type, const std::vector<uint8_t>& data) {
    put32(out, static_cast<uint32_t>(data.size()));
    const size_t begin = out.size();
    out.insert(out.end(), type, type + 4);
    out.insert(out.end(), data.begin(), data.end());
    put32(out, crc(&out[begin], out.size() - begin));
}

// A PNG whose zlib stream holds stored blocks only: simple, and small enough at 4 bits a pixel.
std::vector<uint8_t> encode_png(const Palette& picture) {
    std::vector<uint8_t> rows;
    for (int y = 0; y < picture.height; ++y) {
        rows.push_back(0);
        for (int x = 0; x < picture.width; x += 2) {
            const size_t i = static_cast<size_t>(y * picture.width + x);
            rows.push_back(static_cast<uint8_t>(picture.pixels[i] << 4 | picture.pixels[i + 1]));
        }
    }
    std::vector<uint8_t> stream = {0x78, 0x01};
    for (size_t begin = 0; begin < rows.size(); begin += 65535) {
        const size_t size = std::min<size_t>(65535, rows.size() - begin);
        const auto low = static_cast<uint8_t>(size), high = static_cast<uint8_t>(size >> 8);
        stream.insert(stream.end(), {static_cast<uint8_t>(begin + size == rows.size()), low, high,
                                     static_cast<uint8_t>(~low), static_cast<uint8_t>(~high)});
        stream.insert(stream.end(), rows.begin() + static_cast<ptrdiff_t>(begin),
                      rows.begin() + static_cast<ptrdiff_t>(begin + size));
    }
    uint32_t a = 1, b = 0;
    for (const uint8_t byte : rows) a = (a + byte) % 65521, b = (b + a) % 65521;
    put32(stream, b << 16 | a);

    std::vector<uint8_t> png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, header, colors;
    put32(header, static_cast<uint32_t>(picture.width));
    put32(header, static_cast<uint32_t>(picture.height));
    header.insert(header.end(), {4, 3, 0, 0, 0});
    for (const uint32_t c : picture.colors) {
        colors.insert(colors.end(), {static_cast<uint8_t>(c >> 16), static_cast<uint8_t>(c >> 8), static_cast<uint8_t>(c)});
    }
    put_chunk(png, "IHDR", header);
    put_chunk(png, "PLTE", colors);
    put_chunk(png, "IDAT", stream);
    put_chunk(png, "IEND", {});
    return png;
}

}  // namespace

std::vector<uint8_t> rug_png() {
    Palette rug{{0x6b2430, 0x8a3438, 0xd9c49a, 0x24384d, 0xb9793e, 0x3d5a66}, 248, 152, {}};
    for (int y = 0; y < rug.height; ++y) {
        for (int x = 0; x < rug.width; ++x) {
            // One quarter, mirrored twice; distances from the edge and from the middle.
            const int qx = std::min(x, rug.width - 1 - x), qy = std::min(y, rug.height - 1 - y), edge = std::min(qx, qy);
            const int mx = rug.width / 2 - 1 - qx, my = rug.height / 2 - 1 - qy;
            uint8_t c = (qx / 2 + qy / 2) % 2 ? 0 : 1;
            if (edge < 3) {
                c = 3;
            } else if (edge < 5) {
                c = 2;
            } else if (edge < 20) {  // A border of lozenges.
                const int along = edge == qy ? mx : my, across = std::abs(edge - 12);
                const int phase = std::abs((along + 8) % 16 - 8);
                c = across + phase < 5 ? (across + phase < 2 ? 2 : 4) : 3;
            } else if (edge < 22) {
                c = 2;
            } else if (edge < 24) {
                c = 4;
            } else {  // A medallion, and corners of the same kind.
                const float centre = std::hypot(static_cast<float>(mx) * 0.72f, static_cast<float>(my));
                const float corner = std::hypot(static_cast<float>(qx - 24), static_cast<float>(qy - 24));
                const float petal =
                    4.0f * std::cos(8.0f * std::atan2(static_cast<float>(my), 0.72f * static_cast<float>(mx)));
                const float r = centre + petal,
                            k = corner + 3.0f * std::cos(10.0f * std::atan2(static_cast<float>(qy - 24),
                                                                            static_cast<float>(qx - 24)));
                if (r < 44.0f) c = r < 9 ? 4 : r < 17 ? 2 : r < 19 ? 0 : r < 30 ? 3 : r < 32 ? 2 : r < 41 ? 5 : 2;
                if (k < 32.0f) c = k < 12 ? 4 : k < 14 ? 2 : k < 29 ? 3 : 2;
                const int dx = mx % 22 - 11, dy = my % 22 - 11;
                if (r >= 50.0f && k >= 37.0f && std::abs(dx) + std::abs(dy) < 4) c = std::abs(dx) + std::abs(dy) < 2 ? 2 : 4;
            }
            rug.pixels.push_back(c);
        }
    }
    return encode_png(rug);
}

std::vector<uint8_t> landscape_png() {
    Palette view{
        {0xf0dcb4, 0xeccb96, 0xe5b37c, 0xf6efdc, 0x8fa3a0, 0x6f8a80, 0x557264, 0x3f5a4b, 0x2f4438, 0xd98c5f}, 160, 110, {}};
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const float u = static_cast<float>(x) / 160.0f, v = static_cast<float>(y) / 110.0f;
            const float sun = std::hypot((u - 0.66f) * 1.45f, v - 0.36f);
            uint8_t c = v < 0.2f ? 2 : v < 0.38f ? 1 : 0;
            if (sun < 0.17f) c = 9;
            if (sun < 0.12f) c = 3;
            const float ridges[] = {0.50f + 0.06f * std::sin(7.0f * u + 0.5f) + 0.03f * std::sin(17.0f * u),
                                    0.60f + 0.07f * std::sin(5.0f * u + 2.2f), 0.70f + 0.06f * std::sin(6.5f * u + 4.0f),
                                    0.81f + 0.06f * std::sin(4.2f * u + 1.0f), 0.92f + 0.04f * std::sin(8.0f * u)};
            for (uint8_t k = 0; k < 5; ++k) {
                if (v > ridges[k]) c = static_cast<uint8_t>(4 + k);
            }
            view.pixels.push_back(c);
        }
    }
    return encode_png(view);
}

}  // namespace zoe
