#include "apps/common/contact_sheet.h"

#include <algorithm>

#include "apps/common/picture.h"
#include "engine/scene/image.h"

namespace zoe {
namespace {

constexpr size_t kMaxPictures = 12;
constexpr int kColumns = 4;
constexpr int kThumbnailWidth = 320;
constexpr int kGap = 8;
constexpr uint8_t kPaper = 24;

}  // namespace

std::vector<size_t> spread(size_t count, size_t max_count) {
    std::vector<size_t> positions;
    const size_t taken = std::min(count, max_count);
    for (size_t i = 0; i < taken; ++i) positions.push_back(taken > 1 ? i * (count - 1) / (taken - 1) : 0);
    return positions;
}

void write_contact_sheet(std::span<const std::filesystem::path> pictures, const std::filesystem::path& file,
                         const Grade& grade) {
    std::vector<Picture> thumbnails;
    int cell_width = 1, cell_height = 1;
    for (const size_t i : spread(pictures.size(), kMaxPictures)) {
        thumbnails.push_back(shrink(load_picture(pictures[i], grade), kThumbnailWidth));
        cell_width = std::max(cell_width, thumbnails.back().width);
        cell_height = std::max(cell_height, thumbnails.back().height);
    }

    const int count = static_cast<int>(thumbnails.size());
    const int columns = std::clamp(count, 1, kColumns), rows = std::max(1, (count + columns - 1) / columns);
    const int width = kGap + columns * (cell_width + kGap), height = kGap + rows * (cell_height + kGap);
    std::vector<uint8_t> page(size_t{4} * width * height, kPaper);
    for (size_t i = 3; i < page.size(); i += 4) page[i] = 255;
    for (int i = 0; i < count; ++i) {
        const Picture& thumbnail = thumbnails[i];
        const int left = kGap + i % columns * (cell_width + kGap), top = kGap + i / columns * (cell_height + kGap);
        for (int y = 0; y < thumbnail.height; ++y) {
            const uint8_t* const row = &thumbnail.rgba[size_t{4} * y * thumbnail.width];
            std::copy_n(row, 4 * thumbnail.width, &page[4 * (size_t{1} * (top + y) * width + left)]);
        }
    }
    write_png(file, width, height, page);
}

}  // namespace zoe
