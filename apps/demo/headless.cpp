#include "apps/demo/headless.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "apps/common/contact_sheet.h"
#include "apps/common/interrupt.h"
#include "apps/common/mp4.h"
#include "apps/common/picture.h"
#include "apps/common/progress.h"
#include "apps/common/stats_json.h"
#include "apps/common/trace_events.h"
#include "apps/common/write_file.h"
#include "apps/demo/first_view.h"
#include "engine/render/denoise.h"
#include "engine/render/layers.h"
#include "engine/render/noise.h"
#include "engine/render/past_frame.h"
#include "engine/render/shutter.h"
#include "engine/scene/image_levels.h"

namespace zoe {
namespace {

using Clock = TraceEvents::Clock;

constexpr PictureSize kDefaultSize{640, 360};
constexpr int kDefaultSpp = 8, kDefaultMostSpp = 1024;

double ms_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Samples of each pixel; with a noise that is asked for, the most that one gets. Those of a smoothed picture are the
/// window's.
int samples_of(const Options& options) {
    return options.spp.value_or(options.noise ? kDefaultMostSpp : options.is_denoised ? 1 : kDefaultSpp);
}

struct Run {
    std::vector<std::filesystem::path> pictures;  ///< All of the range, in order.
    int skipped_count = 0;
    RunStats stats;
    TraceEvents events;
    NoiseLimit noise_limit;
};

/// What a frame knows of the one before it.
struct Memory {
    PastFrame past;
    std::optional<int> past_frame;  ///< The number of the one that is kept.
    Guides guides;
    Denoiser denoiser;
    Layers layers;
};

/// The share of a frame's time that the camera's own shutter is open.
double own_shutter(const ViewChoice& view_choice, const Scene& scene) {
    return view_choice.camera ? scene.cameras.at(index(scene[*view_choice.camera].camera)).shutter : 0.0;
}

/// The shutter of a frame: the command line's, else the camera's.
Shutter shutter_of(const Options& options, const ViewChoice& view_choice, const Scene& scene, int frame) {
    const double own = own_shutter(view_choice, scene);
    return {.opens_s = frame / options.fps,
            .open_s = options.is_denoised ? 0.0 : options.shutter.value_or(own) / options.fps,
            .slices = options.slices,
            .seed = static_cast<uint64_t>(frame)};
}

/// Traces a frame. Returns what it did.
/// has_layers they are filled: the frame before is made for their motion where it was not, so that a frame's file does not
///            depend on those that were made before it.
FrameStats make_frame(const Take& take, const Options& options, const Shutter& shutter, int frame, bool has_layers,
                      Film* film, Memory* memory, Run* run, const std::function<void(double)>& report) {
    FrameStats stats;
    const int spp = samples_of(options);
    RenderConfig config;
    config.shade = options.shade;
    config.environment = options.environment.get();
    config.is_jittered = spp > 1;
    config.cancel = &is_interrupted();
    if (options.is_denoised) {
        config.is_jittered = false;
        config.first_number = static_cast<uint32_t>(frame) * static_cast<uint32_t>(spp);
        config.guides = &memory->guides;
        memory->guides.past = &memory->past;
    }
    if (has_layers) {
        config.layers = &memory->layers;
        memory->layers.past = &memory->past;
        if (memory->past_frame != frame - 1) {
            const Clock::time_point before_begin = Clock::now();
            FrameStats before_stats;
            const Tlas& before = take.advance((frame - 1) / options.fps, &before_stats);
            memory->past.keep(before, take.view());
            run->events.add_stages(before_begin, before_stats, frame - 1);
        }
    }
    const Clock::time_point open_begin = Clock::now();
    Exposure exposure(take, shutter, config, film, &stats);
    run->events.add_stages(open_begin, stats, frame);
    if (run->stats.threads == 0) run->stats = describe_run(options.scene, take.scene, exposure.tlas());
    catch_interrupts();  // the first `advance` may be long, and until here nothing was written

    const Clock::time_point trace_begin = Clock::now();
    // What is dark in the picture is dark after its exposure.
    const NoiseConfig noise{.target = static_cast<float>(options.noise.value_or(0.0)),
                            .least_luminance = NoiseConfig{}.least_luminance / options.grade.exposure};
    std::function<bool()> may_go_on;
    if (options.time_limit_s) may_go_on = [&] { return ms_since(trace_begin) < 1e3 * *options.time_limit_s; };
    const auto report_share = [&](double share) {
        const double elapsed = options.time_limit_s ? ms_since(trace_begin) / (1e3 * *options.time_limit_s) : 0.0;
        report(std::max(share, std::min(elapsed, 1.0)));
    };
    if (!run->noise_limit.expose(noise, spp, &exposure, may_go_on, report_share)) throw Interrupted("interrupted");
    if (options.is_denoised) memory->denoiser.filter(memory->guides, {}, film);
    memory->past_frame.reset();
    // After slices, it is another frame's tree.
    if (!exposure.is_sliced() && (has_layers || options.is_denoised)) {
        memory->past.keep(exposure.tlas(), exposure.view());
        memory->past_frame = frame;
    }
    run->events.add("trace", trace_begin, ms_since(trace_begin), frame);
    if (!exposure.is_sliced()) report_rays(take.scene, stats.rays);
    return stats;
}

/// What a picture's file says of itself: nothing that depends on who made it, or when.
PictureNotes notes_of(const Options& options, const ViewChoice& view_choice, const Scene& scene, const Shutter& shutter,
                      const Film& film, int frame) {
    const std::string camera = view_choice.camera    ? scene[*view_choice.camera].name
                               : view_choice.look_at ? "placed"
                                                     : "whole scene";
    return {{"Software", fmt::format("Zoetrope {}", ZOETROPE_VERSION)},
            {"scene", std::filesystem::path(options.scene).filename().string()},
            {"frame", fmt::format("{}", frame)},
            {"time", fmt::format("{:.9g} s", shutter.opens_s)},
            {"shutter", fmt::format("{:.9g} s", shutter.open_s)},
            {"camera", camera},
            {"samples", fmt::format("{:.9g}", mean_samples(film))}};
}

/// Lists the frames whose pictures are to be made: with --resume, those that are not there.
/// Throws     std::runtime_error where a picture's name is a folder's.
std::vector<int> find_missing(const Options& options, PictureSize size, Run* run) {
    std::vector<int> missing;
    int other_size_count = 0;
    std::error_code error;
    for (int frame = options.frames.first; frame <= options.frames.last; ++frame) {
        if (!options.shard.has(options.frames, frame)) continue;
        run->pictures.push_back(options.out(frame));
        const std::filesystem::path& picture = run->pictures.back();
        const std::filesystem::file_status status = std::filesystem::status(picture, error);
        if (std::filesystem::is_directory(status))
            throw std::runtime_error(fmt::format("{}: cannot be written: it is a folder", picture.native()));
        // A file system that filled up leaves empty files.
        if (!options.is_resumed || !std::filesystem::is_regular_file(status) ||
            std::filesystem::file_size(picture, error) == 0) {
            missing.push_back(frame);
            continue;
        }
        const PictureSize other = read_picture_size(picture).value_or(size);
        if (other.width != size.width || other.height != size.height) ++other_size_count;
    }
    run->skipped_count = static_cast<int>(run->pictures.size() - missing.size());
    if (other_size_count > 0) {
        fmt::print(stderr, "zoetrope-demo: warning: of the pictures that are there, {} are not {}x{}\n", other_size_count,
                   size.width, size.height);
    }
    return missing;
}

void make_frames(Content& content, const Options& options, const ViewChoice& view_choice, Run* run) {
    if (options.is_denoised && own_shutter(view_choice, content.scene) > 0.0)
        fmt::print(stderr, "zoetrope-demo: warning: with --denoise the camera's shutter opens for a moment only\n");
    const PictureSize size = options.size.value_or(kDefaultSize);
    set_viewpoint(view_choice, size, 0.0f, &content.scene);  // No frame depends on those before.
    Film film(size.width, size.height);
    Memory memory;
    const Take take{
        .scene = content.scene,
        .advance = [&](double time_s, FrameStats* stats) -> const Tlas& { return advance(content, time_s, stats); },
        .view = [&] { return view_choice.view(content.scene, float(size.width) / float(size.height)); }};
    const bool has_layers = options.out.extension() == ".exr";
    const std::vector<int> missing = find_missing(options, size, run);
    Progress progress("rendering", static_cast<double>(missing.size()));
    for (size_t i = 0; i < missing.size(); ++i) {
        const int frame = missing[i];
        const auto report = [&](double share) {
            progress.update(static_cast<double>(i) + share, fmt::format("frame {}", frame));
        };
        if (is_interrupted()) throw Interrupted("interrupted");
        const Shutter shutter = shutter_of(options, view_choice, content.scene, frame);
        const FrameStats stats = make_frame(take, options, shutter, frame, has_layers, &film, &memory, run, report);
        const Clock::time_point write_begin = Clock::now();
        write_film(film, options.out(frame),
                   {.grade = options.grade,
                    .layers = has_layers ? &memory.layers : nullptr,
                    .notes = notes_of(options, view_choice, content.scene, shutter, film, frame)});
        run->events.add("write", write_begin, ms_since(write_begin), frame);
        run->stats.frames.push_back({.frame = frame, .stats = stats, .samples = mean_samples(film), .peer = {}});
    }
}

void print_stages(const RunStats& run) {
    const auto line = [&](const char* stage, auto value) {
        fmt::print("  {:<12}{:>12.3f}\n", stage, median(run.frames, value));
    };
    fmt::print("median ms a frame ({} frames, {} threads)\n", run.frames.size(), run.threads);
    line("animate", [](const FrameStats& s) { return s.animate_ms; });
    line("deform", [](const FrameStats& s) { return s.deform_ms; });
    line("update_blas", [](const FrameStats& s) { return s.update_blas_ms; });
    line("build_tlas", [](const FrameStats& s) { return s.build_tlas_ms; });
    line("trace", [](const FrameStats& s) { return s.trace_ms; });
    line("frame", [](const FrameStats& s) { return s.frame_ms(); });
    std::vector<double> samples;
    for (const FrameRecord& record : run.frames) samples.push_back(record.samples.value_or(0.0));
    fmt::print("samples a pixel: median {:.1f} a frame\n", percentile(samples, 0.5));
    fmt::print("nodes: ");
    for (int i = 0; i < kMotionCount; ++i)
        fmt::print("{}{} {}", i ? ", " : "", run.node_count[i], name(static_cast<Motion>(i)));
    fmt::print("; median a frame: {} kept, {} refitted, {} rebuilt\n",
               median(run.frames, [](const FrameStats& s) { return s.kept; }),
               median(run.frames, [](const FrameStats& s) { return s.refitted; }),
               median(run.frames, [](const FrameStats& s) { return s.rebuilt; }));
    uint32_t loaded = 0, stored = 0;
    for (const FrameRecord& record : run.frames) {
        loaded += record.stats.loaded;
        stored += record.stats.stored;
    }
    if (loaded + stored > 0) fmt::print("trees: {} read from the cache, {} added to it\n", loaded, stored);
}

void print_pictures(const Run& run) {
    const size_t count = run.pictures.size();
    fmt::print("{:<15}", fmt::format("{} picture{}", count, count == 1 ? "" : "s"));
    if (count > 0) fmt::print("{}", run.pictures.front().native());
    if (count > 1) fmt::print(" ... {}", run.pictures.back().filename().native());
    fmt::print("{}\n", run.skipped_count > 0 ? fmt::format(" ({} were there already)", run.skipped_count) : "");
}

void write_overviews(const Options& options, const Run& run) {
    const std::filesystem::path sheet = options.out.folder() / "contact_sheet.png",
                                film = options.out.folder() / "animation.mp4";
    write_contact_sheet(run.pictures, sheet, options.grade);
    fmt::print("contact sheet  {}\n", sheet.native());
    const std::string reason = write_mp4(run.pictures, options.fps, options.grade, film);
    if (reason.empty()) {
        fmt::print("film           {}\n", film.native());
    } else {
        fmt::print(stderr, "zoetrope-demo: warning: no film was made: {}\n", one_line(reason));
    }
}

}  // namespace

void run_headless(Content& content, const Options& options) {
    const ViewChoice view_choice = first_view(content, options);
    make_folder(options.out.folder());
    if (options.stats) require_writable(*options.stats);
    if (options.trace) require_writable(*options.trace);
    Run run;
    try {
        make_frames(content, options, view_choice, &run);
        print_pictures(run);
        std::fflush(stdout);
        catch_interrupts();  // where every picture was there already
        if (run.pictures.size() > 1 && options.shard.count == 1) write_overviews(options, run);
    } catch (const Interrupted&) {
        throw Interrupted(fmt::format("interrupted; the pictures in {} are whole{}", options.out.folder().native(),
                                      options.is_denoised ? "" : ", and --resume goes on after them"));
    }
    if (options.stats && run.stats.frames.empty()) {  // every picture was there already
        run.stats =
            describe_run(options.scene, content.scene, advance(content, options.frames.first / options.fps, nullptr));
    }
    if (options.stats) write_file(*options.stats, stats_json(run.stats));
    if (options.trace) run.events.write(*options.trace);
    if (!run.stats.frames.empty()) print_stages(run.stats);
    const uint64_t bytes = byte_count(content.scene.images);
    if (bytes > 0) fmt::print("images: {:.1f} MiB with their coarser levels\n", static_cast<double>(bytes) / (1 << 20));
}

}  // namespace zoe
