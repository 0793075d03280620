#include "engine/scene/gltf_file.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "engine/scene/gltf_container.h"
#include "engine/scene/gltf_schema.h"
#include "engine/scene/gltf_uri.h"

namespace zoe {
namespace {

using nlohmann::json;

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 32;
constexpr size_t kMaxJsonBytes = size_t{1} << 28;  // Parsed, JSON takes up to 16 times its length.

json parse_json(std::string_view text, const std::string& file, Scene& scene) {
    if (text.starts_with("\xef\xbb\xbf")) {
        scene.warn("the JSON begins with a byte order mark");
        text.remove_prefix(3);
    }
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
    if (text.size() > kMaxJsonBytes) throw SceneError(file, "", fmt::format("more than {} bytes of JSON", kMaxJsonBytes));
    check_nesting(text, file);
    try {
        return json::parse(text);
    } catch (const json::exception& error) {
        // Its message may quote bytes of the file; keep one clean line.
        std::string reason = error.what();
        const size_t start = reason.find("] ");
        if (start != std::string::npos) reason.erase(0, start + 2);
        for (char& c : reason) {
            if (std::iscntrl(static_cast<unsigned char>(c))) c = ' ';
        }
        throw SceneError(file, "", "not JSON: " + reason.substr(0, 200));
    }
}

void check_version(const json& asset, const std::string& file) {
    const auto major_minor = [&](const char* member, int* major, int* minor) {
        const std::string text = asset.at(member);
        char rest = 0;
        if (std::sscanf(text.c_str(), "%9d.%9d%c", major, minor, &rest) != 2) {
            throw SceneError(file, fmt::format("/asset/{}", member), "'" + text.substr(0, 20) + "' is not a version");
        }
    };
    int major = 0, minor = 0;
    major_minor("version", &major, &minor);
    if (major != 2) throw SceneError(file, "/asset/version", fmt::format("glTF {}.{}; only 2.x is read", major, minor));
    if (!asset.contains("minVersion")) return;
    major_minor("minVersion", &major, &minor);
    if (major != 2 || minor > 0) {
        throw SceneError(file, "/asset/minVersion", fmt::format("it needs glTF {}.{}; 2.0 is read", major, minor));
    }
}

void check_extensions(const json& root, const std::string& file, Scene& scene) {
    const json none = json::array();
    const json& required = root.contains("extensionsRequired") ? root["extensionsRequired"] : none;
    for (size_t i = 0; i < required.size(); ++i) {
        const std::string extension = required[i];
        if (!is_supported_extension(extension)) {
            throw SceneError(file, fmt::format("/extensionsRequired/{}", i),
                             fmt::format("the file needs the extension {}, which is not supported", extension));
        }
    }
    for (const std::string extension : root.contains("extensionsUsed") ? root["extensionsUsed"] : none) {
        if (!is_supported_extension(extension)) {
            scene.warn("extension " + extension + " is not supported: ignored");
        }
    }
}

/// Adds what a URI names to the file's contents, unless it is there.
/// content_of by the file's path.
/// Returns    its position.
size_t read_content(const std::string& uri, const std::string& place, std::map<std::filesystem::path, size_t>& content_of,
                    GltfFile& file) {
    const uint64_t bytes_left = kMaxFileBytes - std::min(kMaxFileBytes, file.byte_count);
    try {
        std::vector<std::byte> bytes;
        if (uri.starts_with("data:")) {
            bytes = read_uri(uri, file.folder, bytes_left);
        } else {
            const std::filesystem::path path = find_uri_file(uri, file.folder);
            const auto [found, is_new] = content_of.try_emplace(path, file.contents.size());
            if (!is_new) return found->second;
            std::error_code failure;
            const uint64_t size = std::filesystem::file_size(path, failure);
            if (!failure && size > bytes_left) {
                throw std::runtime_error(
                    fmt::format("more than {} bytes in the file and its buffers together", kMaxFileBytes));
            }
            bytes = read_whole_file(path, bytes_left);
        }
        file.byte_count += bytes.size();
        file.contents.push_back(std::move(bytes));
    } catch (const std::runtime_error& error) {
        file.fail(place, shown(uri) + ": " + error.what());
    }
    return file.contents.size() - 1;
}

void read_buffers(const json& root, std::span<const std::byte> binary, GltfFile& file, Scene& scene) {
    if (!root.contains("buffers")) return;
    const json& buffers = root["buffers"];
    std::map<std::filesystem::path, size_t> content_of;
    for (size_t i = 0; i < buffers.size(); ++i) {
        const std::string place = fmt::format("/buffers/{}", i);
        GltfBuffer buffer{file.contents.size(), buffers[i]["byteLength"]};
        if (buffers[i].contains("uri")) {
            buffer.content = read_content(buffers[i]["uri"].get_ref<const std::string&>(), place + "/uri", content_of, file);
        } else if (i == 0 && !binary.empty()) {
            file.contents.emplace_back(binary.begin(), binary.end());  // Counted with the file.
            if (binary.size() > buffer.length + 3) scene.warn("the BIN chunk is longer than its buffer");
        } else if (buffer.length > 0) {
            file.fail(place, "it has neither a uri nor a BIN chunk");
        } else {
            file.contents.emplace_back();
        }
        const size_t size = file.contents[buffer.content].size();
        if (size < buffer.length) {
            file.fail(place, fmt::format("byteLength is {}, but there are only {} bytes", buffer.length, size));
        }
        file.buffers.push_back(buffer);
    }
}

void read_views(const json& root, GltfFile& file, Scene& scene) {
    if (!root.contains("bufferViews")) return;
    const json& views = root["bufferViews"];
    for (size_t i = 0; i < views.size(); ++i) {
        GltfView view;
        view.buffer = views[i]["buffer"];
        view.offset = views[i].value("byteOffset", uint64_t{0});
        view.length = views[i]["byteLength"];
        view.stride = views[i].value("byteStride", uint64_t{0});
        const uint64_t size = file.buffers[view.buffer].length;
        if (view.offset > size || view.length > size - view.offset) {
            file.fail(fmt::format("/bufferViews/{}", i), fmt::format("bytes {} to {} are outside its buffer of {}",
                                                                     view.offset, view.offset + view.length, size));
        }
        if (view.stride != 0 && (view.stride < 4 || view.stride > 252 || view.stride % 4 != 0)) {
            scene.warn("a byteStride that is not a multiple of 4 from 4 to 252");
        }
        file.views.push_back(view);
    }
}

void read_images(const json& root, GltfFile& file) {
    if (!root.contains("images")) return;
    for (const json& from : root["images"]) {
        GltfImage image;
        image.name = from.value("name", std::string());
        image.uri = from.value("uri", std::string());
        image.view = from.value("bufferView", -1);
        file.images.push_back(std::move(image));
    }
}

/// Takes out what has been read, and fills in what tinygltf refuses to see missing though it may be.
void prepare_for_tinygltf(json& root, Scene& scene) {
    for (const char* member : {"buffers", "images"}) root.erase(member);
    json& views = root["bufferViews"];
    if (!views.is_array()) views = json::array();
    for (json& view : views) view.erase("byteStride");

    // An index accessor without a view gets one that is no view of ours: every view that is stands before it.
    const size_t view_count = views.size();
    views.push_back({{"buffer", 0}, {"byteLength", 1}});
    if (root.contains("meshes")) {
        for (json& mesh : root["meshes"]) {
            for (json& primitive : mesh["primitives"]) {
                if (!primitive.contains("indices")) continue;
                json& accessor = root["accessors"][primitive["indices"].get<size_t>()];
                if (!accessor.contains("bufferView")) accessor["bufferView"] = view_count;
            }
        }
    }
    if (root.contains("nodes")) {
        for (const json& node : root["nodes"]) {
            const bool has_trs = node.contains("translation") || node.contains("rotation") || node.contains("scale");
            if (has_trs && node.contains("matrix"))
                scene.warn("a node with a matrix and a translation, rotation or scale: the matrix is taken");
        }
    }
    if (root.contains("animations")) {
        for (json& animation : root["animations"]) {
            for (json& channel : animation["channels"]) {
                if (!channel["target"].contains("node")) channel["target"]["node"] = -1;
            }
        }
    }
}

}  // namespace

GltfFile open_gltf(const std::filesystem::path& path, const GltfOptions& options, Scene& scene) {
    GltfFile file;
    file.name = path.string();
    file.folder = path.parent_path();
    std::vector<std::byte> bytes;
    try {
        bytes = read_whole_file(path, kMaxFileBytes);
    } catch (const std::runtime_error& error) {
        throw SceneError(file.name, "", error.what());
    }
    file.byte_count = bytes.size();
    const GltfContainer container = split_gltf(bytes, file.name, scene);
    json root = parse_json(container.json, file.name, scene);
    // First, because another version has another schema, and an extension may replace what the schema asks for.
    if (root.is_object() && root.contains("asset") && root["asset"].is_object() && root["asset"].contains("version") &&
        root["asset"]["version"].is_string()) {
        check_version({{"version", root["asset"]["version"]}}, file.name);
    }
    check_schema(root, file.name, scene);
    check_version(root["asset"], file.name);
    check_extensions(root, file.name, scene);
    read_buffers(root, container.binary, file, scene);
    read_views(root, file, scene);
    read_images(root, file);
    prepare_for_tinygltf(root, scene);

    file.numbers_left = 16 * file.byte_count + options.max_free_numbers;

    const std::string text = root.dump();
    std::string error, warning;
    bool is_read = false;
    try {
        tinygltf::TinyGLTF loader;
        is_read = loader.LoadASCIIFromString(&file.model, &error, &warning, text.data(),
                                             static_cast<unsigned int>(text.size()), "");
    } catch (const std::exception& exception) {
        error = exception.what();
    }
    if (!is_read) {
        while (!error.empty() && std::isspace(static_cast<unsigned char>(error.back()))) error.pop_back();
        std::replace(error.begin(), error.end(), '\n', ' ');
        throw SceneError(file.name, "", error.empty() ? "it cannot be read" : error);
    }
    return file;
}

}  // namespace zoe
