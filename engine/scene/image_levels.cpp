#include "engine/scene/image_levels.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <numeric>

#include "engine/math/parallel.h"
#include "engine/scene/half.h"
#include "engine/scene/srgb.h"

namespace zoe {

namespace {

constexpr size_t kRowsATask = 16;

/// The texels that one of the coarser row covers, as exact shares in units of 1 / to: [i * from, (i + 1) * from) in steps of
/// `to`. Where `from` is even they are two halves.
struct Cover {
    int first = 0, count = 0;
    std::array<float, 3> share{};  // 2 to 3 texels: from <= 2 * to
};

Cover cover(int i, int from, int to) {
    const int64_t begin = int64_t{i} * from, end = begin + from;
    Cover result;
    result.first = static_cast<int>(begin / to);
    for (int64_t at = begin; at < end; ++result.count) {
        const int64_t next = std::min(end, (at / to + 1) * to);
        result.share[static_cast<size_t>(result.count)] = static_cast<float>(next - at) / static_cast<float>(from);
        at = next;
    }
    return result;
}

/// What levels do with a texel's channels: bytes, of which the first three may be sRGB, or halves.
struct ByteTexel {
    using Channel = uint8_t;
    bool is_color;

    float decode(uint8_t byte, size_t channel) const {
        return is_color && channel < 3 ? linear_from_srgb_byte(byte) : static_cast<float>(byte);
    }
    uint8_t encode(float number, size_t channel) const {
        return is_color && channel < 3 ? srgb_byte_from_linear(number) : static_cast<uint8_t>(number + 0.5f);
    }
};

struct HalfTexel {
    using Channel = uint16_t;

    float decode(uint16_t half, size_t) const { return float_from_half(half); }
    uint16_t encode(float number, size_t) const { return half_from_float(std::min(number, float_from_half(kHalfLargest))); }
};

/// An image and its levels without what they hold.
Image sizes_of(const Image& image) {
    Image sizes;
    sizes.is_half = image.is_half;
    sizes.halvings = image.halvings;
    sizes.width = image.width;
    sizes.height = image.height;
    for (const ImageLevel& level : image.coarser) sizes.coarser.push_back({level.width, level.height, {}});
    return sizes;
}

/// A copy whose finest level is one of the image's coarser ones.
Image from_level(const Image& image, size_t level) {
    if (level == 0) return image;
    Image copy;
    copy.is_color = image.is_color;
    copy.is_light = image.is_light;
    copy.is_half = image.is_half;
    copy.replaced = image.replaced;
    copy.halvings = image.halvings + static_cast<int>(level);
    copy.width = image.coarser[level - 1].width;
    copy.height = image.coarser[level - 1].height;
    copy.pixels = image.coarser[level - 1].pixels;
    copy.coarser.assign(image.coarser.begin() + static_cast<std::ptrdiff_t>(level), image.coarser.end());
    return copy;
}

/// Halves an image until it has the size that it is given, or drops its pixels where that is none.
void fit_to(const Image& sizes, Image* image) {
    while (image->halvings < sizes.halvings && !image->coarser.empty()) drop_finest(image);
    image->halvings = sizes.halvings;
    if (sizes.width > 0) return;
    image->width = image->height = 0;
    image->pixels = {};
}

template <typename Texel>
ImageLevel halve(const ImageLevel& from, const Texel& texel) {
    using Channel = typename Texel::Channel;
    constexpr size_t kTexelBytes = 4 * sizeof(Channel);
    assert(from.width > 0 && from.height > 0);
    ImageLevel to{(from.width + 1) / 2, (from.height + 1) / 2, {}};
    const size_t from_row = static_cast<size_t>(from.width), to_row = static_cast<size_t>(to.width);
    to.pixels.resize(kTexelBytes * to_row * static_cast<size_t>(to.height));
    const auto halve_row = [&](size_t y) {
        const Cover rows = cover(static_cast<int>(y), from.height, to.height);
        for (int x = 0; x < to.width; ++x) {
            const Cover columns = cover(x, from.width, to.width);
            float sum[4] = {0.0f, 0.0f, 0.0f, 0.0f};
            Channel channels[4];
            for (int j = 0; j < rows.count; ++j) {
                for (int i = 0; i < columns.count; ++i) {
                    const size_t at =
                        static_cast<size_t>(rows.first + j) * from_row + static_cast<size_t>(columns.first + i);
                    const float share = rows.share[static_cast<size_t>(j)] * columns.share[static_cast<size_t>(i)];
                    std::memcpy(channels, &from.pixels[kTexelBytes * at], kTexelBytes);
                    for (size_t c = 0; c < 4; ++c) sum[c] += share * texel.decode(channels[c], c);
                }
            }
            for (size_t c = 0; c < 4; ++c) channels[c] = texel.encode(sum[c], c);
            std::memcpy(&to.pixels[kTexelBytes * (y * to_row + static_cast<size_t>(x))], channels, kTexelBytes);
        }
    };
    parallel_for(0, static_cast<size_t>(to.height), kRowsATask, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y) halve_row(y);
    });
    return to;
}

}  // namespace

ImageLevel halved(const ImageLevel& from, bool is_color, bool is_half) {
    return is_half ? halve(from, HalfTexel{}) : halve(from, ByteTexel{is_color});
}

void make_levels(Image* image) {
    image->coarser.clear();
    if (image->pixels.empty()) return;
    // Lent, not copied, as what the first level is made of.
    ImageLevel finest{image->width, image->height, std::move(image->pixels)};
    const ImageLevel* last = &finest;
    while (last->width > 1 || last->height > 1) {
        image->coarser.push_back(halved(*last, image->is_color, image->is_half));
        last = &image->coarser.back();
    }
    image->pixels = std::move(finest.pixels);
}

void drop_finest(Image* image) {
    assert(!image->coarser.empty());
    ImageLevel& next = image->coarser.front();
    image->width = next.width;
    image->height = next.height;
    image->pixels = std::move(next.pixels);
    image->coarser.erase(image->coarser.begin());
    ++image->halvings;
}

uint64_t pixel_worth(const Image& image) {
    return static_cast<uint64_t>(image.width) * static_cast<uint64_t>(image.height) * image.texel_bytes() / 4;
}

void fit_images(std::vector<Image>* images, uint64_t max_pixels) {
    uint64_t total = 0;
    for (const Image& image : *images) total += pixel_worth(image);
    // Largest first; of equal ones the first in the list.
    const auto is_smaller = [&](size_t a, size_t b) {
        const uint64_t count_a = pixel_worth((*images)[a]), count_b = pixel_worth((*images)[b]);
        return count_a != count_b ? count_a < count_b : a > b;
    };
    std::vector<size_t> heap(total > max_pixels ? images->size() : 0);
    std::iota(heap.begin(), heap.end(), size_t{0});
    std::make_heap(heap.begin(), heap.end(), is_smaller);
    while (total > max_pixels && !(*images)[heap.front()].coarser.empty()) {
        std::pop_heap(heap.begin(), heap.end(), is_smaller);
        Image& image = (*images)[heap.back()];
        total -= pixel_worth(image);
        drop_finest(&image);
        total += pixel_worth(image);
        std::push_heap(heap.begin(), heap.end(), is_smaller);
    }
    for (size_t i = images->size(); i-- > 0 && total > max_pixels;) {
        Image& image = (*images)[i];
        total -= pixel_worth(image);
        image.width = image.height = 0;
        image.pixels = {};
    }
}

int make_room(const Image& added, std::vector<Image>* images, uint64_t max_pixels) {
    std::vector<Image> sizes;
    for (const Image& image : *images) sizes.push_back(sizes_of(image));
    sizes.push_back(sizes_of(added));
    std::vector<ImageLevel>& coarser = sizes.back().coarser;
    coarser.clear();
    for (int width = added.width, height = added.height; width > 1 || height > 1;) {
        width = (width + 1) / 2;
        height = (height + 1) / 2;
        coarser.push_back({width, height, {}});
    }
    fit_images(&sizes, max_pixels);
    for (size_t i = 0; i < images->size(); ++i) fit_to(sizes[i], &(*images)[i]);
    return sizes.back().halvings - added.halvings;
}

void copy_and_fit(const std::vector<size_t>& originals, std::vector<Image>* images, uint64_t max_pixels) {
    std::vector<Image> sizes;
    for (const size_t original : originals) sizes.push_back(sizes_of((*images)[original]));
    fit_images(&sizes, max_pixels);
    // Of an image and its copies, the one that is halved least takes what was decoded; it has all that the others need.
    std::vector<size_t> holders(originals.size());
    std::iota(holders.begin(), holders.end(), size_t{0});
    for (size_t i = 0; i < originals.size(); ++i) {
        size_t& holder = holders[originals[i]];
        if (sizes[i].halvings < sizes[holder].halvings) holder = i;
    }
    for (size_t i = 0; i < originals.size(); ++i) {
        if (originals[i] != i) continue;
        Image &image = (*images)[i], &holder = (*images)[holders[i]];
        std::swap(image, holder);
        std::swap(image.name, holder.name);
        for (int left = sizes[holders[i]].halvings - holder.halvings; left > 0; --left) drop_finest(&holder);
    }
    for (size_t i = 0; i < originals.size(); ++i) {
        const size_t from = holders[originals[i]];
        if (from == i || sizes[i].width == 0) continue;
        std::string name = std::move((*images)[i].name);
        (*images)[i] = from_level((*images)[from], static_cast<size_t>(sizes[i].halvings - (*images)[from].halvings));
        (*images)[i].name = std::move(name);
    }
    for (size_t i = 0; i < originals.size(); ++i) fit_to(sizes[i], &(*images)[i]);
}

uint64_t byte_count(std::span<const Image> images) {
    uint64_t total = 0;
    for (const Image& image : images) {
        total += image.pixels.size();
        for (const ImageLevel& level : image.coarser) total += level.pixels.size();
    }
    return total;
}

}  // namespace zoe
