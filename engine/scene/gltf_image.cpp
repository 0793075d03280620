#include <algorithm>
#include <map>
#include <span>
#include <stdexcept>

#include "engine/scene/decode_image.h"
#include "engine/scene/gltf_material.h"
#include "engine/scene/gltf_uri.h"
#include "engine/scene/image_levels.h"

namespace zoe {
namespace {

constexpr uint64_t kMaxImageBytes = uint64_t{1} << 30;

/// read       gets the bytes where they are not in the file's memory.
std::span<const std::byte> encoded_bytes(const GltfFile& file, const GltfImage& image, std::vector<std::byte>* read) {
    if (image.view >= 0) {
        const GltfView& view = file.views[static_cast<size_t>(image.view)];
        return file.buffer(view.buffer).subspan(view.offset, view.length);
    }
    if (image.uri.empty()) throw std::runtime_error("it has neither a uri nor a bufferView");
    *read = read_uri(image.uri, file.folder, kMaxImageBytes);
    return *read;
}

/// Equal for images whose encoded bytes are the same ones.
/// Throws     std::runtime_error with the reason why there are none.
std::string source_of(const GltfFile& file, const GltfImage& image) {
    if (image.view >= 0) {
        const GltfView& view = file.views[static_cast<size_t>(image.view)];
        return fmt::format("view {} {} {}", file.buffers[view.buffer].content, view.offset, view.length);
    }
    if (image.uri.empty() || image.uri.starts_with("data:")) return image.uri;
    return find_uri_file(image.uri, file.folder).string();
}

/// How materials show an image, as what asks for most.
enum class Shown : uint8_t { kNot, kAsNumbers, kAsColor, kAsLight };

/// An image that has been decoded, or the reason why not.
struct Decoded {
    size_t image = 0;
    std::string error;
};

/// By source_of, and by what the numbers mean.
using DecodedImages = std::map<std::pair<std::string, Shown>, Decoded>;

/// The images so far, and what they may take.
struct Room {
    uint64_t max_pixels;
    std::vector<Image> images;
    uint64_t pixel_count = 0;  ///< Of them all, as pixel_worth counts.

    /// Halves images where one more needs that.
    /// Returns    how often that one is to be halved.
    int make(const Image& added) {
        if (pixel_count + pixel_worth(added) <= max_pixels) return 0;
        const int halvings = make_room(added, &images, max_pixels);
        count();
        return halvings;
    }
    void add(Image image) {
        pixel_count += pixel_worth(image);
        images.push_back(std::move(image));
        if (pixel_count <= max_pixels) return;
        fit_images(&images, max_pixels);  // What decoding could not halve often enough.
        count();
    }

private:
    void count() {
        pixel_count = 0;
        for (const Image& image : images) pixel_count += pixel_worth(image);
    }
};

/// Fills an image's pixels, unless an image before it has them; for that, those before it are halved where they must be.
/// originals  of the images before it; its own is added.
/// Returns    the reason why it has none; empty where all is well.
/// Throws     std::runtime_error with the reason, too.
std::string read_pixels(const GltfFile& file, const GltfImage& from, Shown as, DecodedImages& decoded,
                        std::vector<size_t>& originals, Room* room, Image& image) {
    originals.push_back(originals.size());
    const auto [found, is_new] = decoded.try_emplace({source_of(file, from), as}, Decoded{originals.back(), {}});
    std::string& error = found->second.error;
    originals.back() = found->second.image;
    if (is_new) {
        try {
            std::vector<std::byte> read;
            decode_image(encoded_bytes(file, from, &read), &image, &error, room->max_pixels,
                         [&](const Image& size) { return room->make(size); });
        } catch (const std::runtime_error& exception) {
            error = exception.what();
        }
        make_levels(&image);
    }
    return error;
}

std::vector<Shown> how_shown(size_t image_count, const Scene& scene) {
    std::vector<Shown> shown(image_count, Shown::kNot);
    for (const Material& material : scene.materials) {
        const auto textures = textures_of(material);
        for (size_t i = 0; i < textures.size(); ++i) {
            if (textures[i]->image == kNone<ImageId>) continue;
            Shown& as = shown[index(textures[i]->image)];
            const bool is_light = textures[i] == &material.emission_texture;
            as = std::max(as, is_light ? Shown::kAsLight : i < kColorTextureCount ? Shown::kAsColor : Shown::kAsNumbers);
        }
    }
    return shown;
}

std::string place_of(const GltfImage& from, size_t i) {
    return fmt::format("/images/{}{}", i, from.view >= 0 ? "" : " (" + shown(from.uri) + ")");
}

}  // namespace

std::vector<Image> read_images(const GltfFile& file, const GltfOptions& options, Scene& scene) {
    const std::vector<Shown> as = how_shown(file.images.size(), scene);
    DecodedImages decoded;
    Room room{.max_pixels = options.max_pixels, .images = {}};
    std::vector<size_t> originals;
    for (size_t i = 0; i < file.images.size(); ++i) {
        const GltfImage& from = file.images[i];
        Image image;
        image.name = !from.name.empty() ? from.name : from.uri.starts_with("data:") ? std::string() : from.uri;
        image.is_color = as[i] != Shown::kAsNumbers;
        image.is_light = as[i] == Shown::kAsLight;
        if (options.load_images && as[i] != Shown::kNot) {
            std::string error;
            try {
                error = read_pixels(file, from, as[i], decoded, originals, &room, image);
            } catch (const std::runtime_error& exception) {
                error = exception.what();
            }
            if (!error.empty()) scene.warn(fmt::format("{}: {}: not shown", place_of(from, i), error));
        }
        room.add(std::move(image));
        originals.resize(room.images.size(), i);
    }
    std::vector<Image> images = std::move(room.images);
    copy_and_fit(originals, &images, options.max_pixels);
    for (size_t i = 0; i < images.size(); ++i) {
        if (images[i].replaced > 0) {
            scene.warn(fmt::format("{}: {} of its numbers are not from 0 to {}: replaced", place_of(file.images[i], i),
                                   images[i].replaced, images[i].is_light ? "65504, or of alpha to 1" : "1"));
        }
        if (images[i].halvings == 0) continue;
        scene.warn(fmt::format("{}: halved {} times, to {} x {} texels: images may have {} together",
                               place_of(file.images[i], i), images[i].halvings, images[i].width, images[i].height,
                               options.max_pixels));
    }
    return images;
}

}  // namespace zoe
