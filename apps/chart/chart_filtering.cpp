#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/noise.h"
#include "engine/math/rng.h"
#include "engine/scene/image_levels.h"

namespace zoe::chart {
namespace {

constexpr const char* kRmse = "RMSE of a textured floor that runs to the horizon";
constexpr float kFloorSize = 60.0f;  // metres from the eye's foot to its edges
constexpr int kTexels = 128;         // a side; a metre of floor
constexpr uint64_t kSeed = 17;

/// Random tiles of 2 x 2 texels, black or white.
Image make_tiles() {
    Image image{.width = kTexels, .height = kTexels};
    Rng rng(kSeed);
    std::vector<uint8_t> tiles(kTexels * kTexels / 4);
    for (uint8_t& tile : tiles) tile = rng.below(2) == 0 ? 20 : 235;
    for (int y = 0; y < kTexels; ++y) {
        for (int x = 0; x < kTexels; ++x) {
            const uint8_t tile = tiles[static_cast<size_t>(y / 2 * (kTexels / 2) + x / 2)];
            image.pixels.insert(image.pixels.end(), {tile, tile, tile, 255});
        }
    }
    make_levels(&image);
    return image;
}

/// The floor as the texture has it, without light.
Scene make_floor(bool has_levels) {
    Scene scene;
    scene.images.push_back(make_tiles());
    Material material;
    material.is_unlit = material.is_double_sided = true;
    material.base_color_texture.image = ImageId{0};
    if (!has_levels) material.base_color_texture.levels = LevelFilter::kFinest;
    const MaterialId tiles = scene.add(material);
    Mesh mesh;
    for (const float x : {-kFloorSize, kFloorSize}) {
        for (const float z : {-kFloorSize, kFloorSize}) {
            mesh.positions.push_back({x, 0.0f, z});
            mesh.uvs[0].push_back({x, z});
        }
    }
    mesh.corners = {{0, 1, 3}, {0, 3, 2}};
    mesh.materials = {{0, 2, tiles}};
    Node node;
    node.mesh = scene.add(std::move(mesh));
    scene.add(std::move(node));
    return scene;
}

struct Floor {
    Scene scene;
    const Tlas& tlas;
    View view;

    Floor(bool has_levels, float aspect)
        : scene(make_floor(has_levels)),
          tlas(advance(scene, 0.0)),
          view(look_at({0, 1.6f, 0}, {2.0f, 0.6f, -5.0f}, 50.0f, aspect)) {}

    void render(int sample_count, Film* film) const {
        RenderConfig config;
        config.sky_strength = config.sun_strength = 0.0f;
        zoe::render(scene, tlas, view, config, sample_count, film, nullptr);
    }
};

std::vector<Row> measure(const Settings& settings) {
    const int width = settings.pick(40, 128, 240), height = settings.pick(24, 72, 135);
    const float aspect = float(width) / float(height);
    const Floor finest(false, aspect), cones(true, aspect);
    const Rendering exact{.series = "always the finest",
                          .render = [&](int sample_count, Film* film) { finest.render(sample_count, film); }};
    const std::vector<glm::dvec3> reference = render_reference(exact, width, height, settings.pick(2048, 2048, 16'384));
    const Rendering ours{.series = "by ray cones",
                         .render = [&](int sample_count, Film* film) { cones.render(sample_count, film); },
                         .is_default = true};
    return measure_noise({ours, exact}, width, height, settings.pick(64, 256, 1024), reference, kRmse, "");
}

std::string caption(const Chart& chart) {
    const Series &cones = *chart.panel(kRmse).find("by ray cones"), &finest = *chart.panel(kRmse).find("always the finest");
    std::string from = "never, up to " + finest.points.back().label;
    for (size_t k = finest.points.size(); k-- > 0 && finest.points[k].y.median < cones.points[k].y.median;)
        from = "from " + finest.points[k].label + " on";
    const auto share = [&](size_t k) { return short_number(cones.points[k].y.median / finest.points[k].y.median); };
    return fmt::format(
        "Points: 1, 2, 4, ... {} samples a pixel, against a picture of many others that looks up the finest texels. Levels "
        "by "
        "ray cones (default) have {} of the error with one sample, {} with 8 and {} with the most: what is blurred stays "
        "blurred. At equal samples the finest level is nearer: {}.",
        finest.points.back().label, share(0), share(3), share(finest.points.size() - 1), from);
}

}  // namespace

Chart filtering(Sweep& sweep) {
    Chart chart{.name = "filtering", .question = find_chart("filtering").question};
    chart.panels = {{.name = kRmse,
                     .x = {.name = "time", .unit = "s", .is_log = true},
                     .y = {.name = "RMSE", .unit = "radiance", .is_log = true},
                     .is_trade = true}};
    const Settings settings = sweep.settings();
    sweep.run({{.name = "levels", .measure = [=] { return measure(settings); }}}, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
