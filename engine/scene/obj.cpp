#include "engine/scene/obj.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "engine/scene/check_surface.h"
#include "engine/scene/obj_lines.h"

namespace zoe {
namespace {

constexpr uint32_t kMissing = UINT32_MAX;
constexpr uint64_t kMaxElements = uint64_t{1} << 27;  // Of each kind.

/// Places of a corner's position, texture coordinate and normal.
using Corner = std::array<uint32_t, 3>;

struct ObjFile {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<uint32_t> face_sizes;
    std::vector<Corner> corners;
};

std::string_view take_word(std::string_view* line) {
    const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
    size_t begin = 0;
    while (begin < line->size() && is_space((*line)[begin])) ++begin;
    size_t end = begin;
    while (end < line->size() && !is_space((*line)[end])) ++end;
    const std::string_view word = line->substr(begin, end - begin);
    line->remove_prefix(end);
    return word;
}

/// As exporters write numbers: with a plus in front, too.
std::string_view without_plus(std::string_view word) {
    const bool has_plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
    return has_plus ? word.substr(1) : word;
}

/// Whether a decimal number, well formed, is nearer to 0 than 1 is: by the place of its first digit that counts.
bool is_below_one(std::string_view number) {
    const size_t exponent_at = std::min(number.find_first_of("eE"), number.size());
    const std::string_view digits = number.substr(0, exponent_at);
    const size_t first = digits.find_first_of("123456789"), point = std::min(digits.find('.'), digits.size());
    if (first == digits.npos) return true;
    const int64_t place = static_cast<int64_t>(point) - static_cast<int64_t>(first) - (first < point ? 1 : 0);
    const std::string_view text = number.substr(std::min(exponent_at + 1, number.size()));
    const bool is_negative = text.starts_with('-');
    int64_t exponent = 0;
    const auto [end, error] =
        std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), text.data() + text.size(), exponent);
    if (error == std::errc::result_out_of_range) return is_negative;
    return exponent < -place;
}

/// What is too small for a float is 0.
/// Returns    whether it is a number, and a finite one.
bool read_number(std::string_view word, float* number) {
    const std::string_view text = without_plus(word);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
    if (end != text.data() + text.size()) return false;
    if (error == std::errc::result_out_of_range && is_below_one(text)) {
        *number = 0.0f;
        return true;
    }
    return error == std::errc{} && std::isfinite(*number);
}

/// Reads the file line by line.
class ObjReader {
public:
    ObjReader(const std::filesystem::path& path, const ObjOptions& options, Scene& scene)
        : name_(path.string()), options_(options), scene_(scene) {}

    ObjFile read() {
        std::ifstream stream(name_, std::ios::binary);
        if (!stream) throw SceneError(name_, "", "it cannot be opened");
        ObjLines lines(stream, options_.max_line_bytes);
        std::string line;
        try {
            while (lines.next(&line)) {
                line_number_ = lines.number();
                read_line(line);
            }
        } catch (const std::length_error& error) {
            line_number_ = lines.number();
            fail(error.what());
        }
        if (stream.bad()) throw SceneError(name_, "", "it cannot be read");
        return std::move(file_);
    }

private:
    [[noreturn]] void fail(const std::string& reason) const {
        throw SceneError(name_, fmt::format("line {}", line_number_), reason);
    }

    void read_line(std::string_view line) {
        line = line.substr(0, line.find('#'));
        const std::string_view keyword = take_word(&line);
        if (keyword.empty()) return;
        if (keyword == "v") {
            const auto [numbers, count] = take_numbers<7>(&line, 3);
            if (count > 4) scene_.warn("colours of an .obj file's vertices: ignored");
            append(&file_.positions, glm::vec3(numbers[0], numbers[1], numbers[2]));
        } else if (keyword == "vt") {
            const auto [numbers, count] = take_numbers<3>(&line, 1);
            append(&file_.uvs, glm::vec2(numbers[0], 1.0f - numbers[1]));  // glTF counts downwards.
        } else if (keyword == "vn") {
            const auto [numbers, count] = take_numbers<3>(&line, 3);
            append(&file_.normals, glm::vec3(numbers[0], numbers[1], numbers[2]));
        } else if (keyword == "f") {
            read_face(line);
        } else if (keyword != "o" && keyword != "g" && keyword != "s") {
            static constexpr std::string_view kMaterials[] = {"usemtl", "mtllib"};
            const bool is_material =
                std::find(std::begin(kMaterials), std::end(kMaterials), keyword) != std::end(kMaterials);
            scene_.warn(is_material ? "materials of an .obj file: ignored"
                                    : "lines of an .obj file that are neither v, vt, vn nor f: ignored");
        }
    }

    template <typename T>
    void append(std::vector<T>* to, const T& value) const {
        if (to->size() >= kMaxElements) fail(fmt::format("more than {} of one kind", kMaxElements));
        to->push_back(value);
    }

    /// Returns    the numbers, 0 where there are none, and how many there are.
    template <size_t kMost>
    std::pair<std::array<float, kMost>, size_t> take_numbers(std::string_view* line, size_t least) const {
        std::array<float, kMost> numbers{};
        size_t count = 0;
        for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
            if (count == kMost) fail(fmt::format("more than {} numbers", kMost));
            if (!read_number(word, &numbers[count])) fail(fmt::format("'{}' is not a number", word.substr(0, 40)));
            ++count;
        }
        if (count < least) fail(fmt::format("{} numbers, where {} are needed", count, least));
        return {numbers, count};
    }

    void read_face(std::string_view line) {
        const size_t first = file_.corners.size();
        for (std::string_view word = take_word(&line); !word.empty(); word = take_word(&line)) {
            if (file_.corners.size() >= options_.max_corners) {
                fail(fmt::format("more than {} corners of polygons", options_.max_corners));
            }
            file_.corners.push_back(read_corner(word));
        }
        const size_t size = file_.corners.size() - first;
        if (size < 3) fail(fmt::format("a polygon of {} corners", size));
        file_.face_sizes.push_back(static_cast<uint32_t>(size));
    }

    Corner read_corner(std::string_view word) const {
        const size_t counts[] = {file_.positions.size(), file_.uvs.size(), file_.normals.size()};
        Corner corner = {kMissing, kMissing, kMissing};
        std::string_view rest = word;
        for (int k = 0; k < 3; ++k) {
            const size_t slash = rest.find('/');
            const std::string_view text = rest.substr(0, slash);
            if (!text.empty()) corner[k] = read_index(text, counts[k]);
            if (slash == rest.npos) break;
            rest.remove_prefix(slash + 1);
            if (k == 2) fail(fmt::format("'{}' is not a corner", word.substr(0, 40)));
        }
        if (corner[0] == kMissing) fail(fmt::format("'{}' names no vertex", word.substr(0, 40)));
        return corner;
    }

    uint32_t read_index(std::string_view word, size_t count) const {
        const std::string_view text = without_plus(word);
        int64_t number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc{} || end != text.data() + text.size()) {
            fail(fmt::format("'{}' is not an index", word.substr(0, 40)));
        }
        const int64_t size = static_cast<int64_t>(count);
        if (number == 0 || number > size || number < -size) fail(fmt::format("index {} of {}", number, count));
        return static_cast<uint32_t>(number > 0 ? number - 1 : size + number);
    }

    std::string name_;
    const ObjOptions& options_;
    Scene& scene_;
    uint64_t line_number_ = 0;
    ObjFile file_;
};

/// Corners that are the same in all three become one vertex.
Mesh make_triangles(const ObjFile& file) {
    std::vector<uint32_t> order(file.corners.size()), vertex_of(file.corners.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return file.corners[a] < file.corners[b]; });
    Mesh mesh;
    for (size_t k = 0; k < order.size(); ++k) {
        const Corner& corner = file.corners[order[k]];
        if (k == 0 || corner != file.corners[order[k - 1]]) {
            mesh.positions.push_back(file.positions[corner[0]]);
            if (!file.uvs.empty()) mesh.uvs[0].push_back(corner[1] == kMissing ? glm::vec2(0.0f) : file.uvs[corner[1]]);
            if (!file.normals.empty()) {
                mesh.normals.push_back(corner[2] == kMissing ? glm::vec3(0.0f) : file.normals[corner[2]]);
            }
        }
        vertex_of[order[k]] = static_cast<uint32_t>(mesh.positions.size() - 1);
    }
    mesh.corners = split_faces({.face_sizes = file.face_sizes, .vertices = vertex_of});
    return mesh;
}

Mesh make_cage(ObjFile file, int level) {
    SubdivisionSurface surface{.options = {.level = level}};
    surface.cage.face_sizes = std::move(file.face_sizes);
    const bool has_uvs =
        std::any_of(file.corners.begin(), file.corners.end(), [](const Corner& c) { return c[1] != kMissing; });
    for (const Corner& corner : file.corners) {
        surface.cage.vertices.push_back(corner[0]);
        if (has_uvs)
            surface.cage.uvs[0].corners.push_back(std::min<uint32_t>(corner[1], static_cast<uint32_t>(file.uvs.size())));
    }
    if (has_uvs) {
        surface.cage.uvs[0].values = std::move(file.uvs);
        surface.cage.uvs[0].values.push_back(glm::vec2(0.0f));  // Of corners that have none.
    }
    return make_surface(std::move(file.positions), std::move(surface));
}

}  // namespace

Scene load_obj(const std::filesystem::path& path, const ObjOptions& options) {
    Scene scene;
    scene.file = path.string();
    ObjFile file = ObjReader(path, options, scene).read();
    if (file.face_sizes.empty()) throw SceneError(scene.file, "", "it has no polygons");
    Mesh mesh = options.subdivision_level ? make_cage(std::move(file), *options.subdivision_level) : make_triangles(file);
    Node node;
    node.name = mesh.name = path.stem().string();
    node.mesh = scene.add(std::move(mesh));
    scene.add(std::move(node));
    std::string broken = check(scene);
    if (broken.empty()) broken = check_surface_size(scene, options.max_triangles);
    if (!broken.empty()) throw SceneError(scene.file, "", broken);
    return scene;
}

}  // namespace zoe
