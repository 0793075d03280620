#include "apps/demo/options.h"

#include <bit>
#include <cmath>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/common/open_scene.h"
#include "apps/common/parse_command_line.h"
#include "apps/common/usage_error.h"

namespace zoe {
namespace {

/// Options whose text is checked after all of them were read.
struct Texts {
    std::string frames, shard, eye, target, origin, size, sky, sun, shade, tone, out, cache;
    double exposure_stops = 0.0;
};

struct Flags {
    bool loops = false, stays = false, has_no_cache = false;
};

std::string footer() {
    std::string text =
        "Examples:\n"
        "  zoetrope-demo                                  the project's own scene, in a window\n"
        "  zoetrope-demo fox.glb --clip Run               one clip of a file\n"
        "  zoetrope-demo fox.glb --headless --frames 0-71 three seconds as pictures in out/\n"
        "  zoetrope-demo --shade motion                   how each node moves: its motion class\n"
        "  zoetrope-demo --out out/f_%04d.exr --spp 64    EXR layers: colour, depth, ids, albedo, normals, motion\n"
        "  zoetrope-demo --frames 0-239 --shutter 0.5     what moves is blurred, as a film camera does\n"
        "  zoetrope-demo --frames 0-239 --shard 3/8       the third of eight machines' shares\n"
        "  zoetrope-demo 'wave_%04d.glb'                  a mesh a frame\n"
        "  zoetrope-demo cage.obj --subdivide 3           a smooth surface over a cage of quads\n\n"
        "Scenes made by this project, as NAME or NAME-SIZE (instances-100000):\n";
    for (const ContentInfo& info : content_list()) {
        const std::string size = info.max_size > 0 ? fmt::format("; {} unless told", info.default_size) : "";
        text += fmt::format("  {:<16} {}{}\n", info.name, info.description, size);
    }
    text +=
        "\nIn the window, F1 shows the keys. Without a display the demo runs headless.\n"
        "Exit codes: 0 done, 1 the scene or a file is at fault, 2 the command line is, 130 interrupted.";
    return text;
}

void add_options(CLI::App& app, Options& options, Texts& texts, Flags& flags) {
    app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);  // so that a script's can be overridden
    app.add_option("SCENE", options.scene,
                   "A .glb, .gltf or .obj file, a mesh sequence (wave_%04d.glb), or a name from the list below")
        ->type_name("")
        ->capture_default_str();

    app.add_option("--subdivide", options.level,
                   "Level of all subdivision surfaces; makes the polygons of an .obj file the cage of one")
        ->type_name("LEVEL")
        ->check(CLI::Range(1, kMaxSubdivisionLevel));

    const char* const what = "What plays";
    app.add_option("--clip", options.clip, "The clip that plays (the first, unless told), or all at once")
        ->type_name("NAME|INDEX|all")
        ->group(what);
    app.add_flag("--loop", flags.loops, "At their end, clips start again (so unless told) ...")->group(what);
    app.add_flag("--no-loop", flags.stays, "... or stay as they are")->group(what);
    app.add_option("--fps", options.fps, "Frames a second: frame N is the scene at N / fps seconds")
        ->type_name("N")
        ->capture_default_str()
        ->group(what);

    const char* const seen = "How it is seen";
    app.add_option("--camera", options.camera, "A camera of the file (the first, unless told)")
        ->type_name("NAME|INDEX")
        ->group(seen);
    app.add_option("--eye", texts.eye, "Look from here, +Y up, ...")->type_name("X,Y,Z")->group(seen);
    app.add_option("--target", texts.target, "... at this point, ...")->type_name("X,Y,Z")->group(seen);
    app.add_option("--fov", options.fov_degrees, "... with this vertical field of view (45)")->type_name("DEG")->group(seen);
    app.add_option("--origin", texts.origin, "Where numbers are the most exact: for scenes kilometres from (0, 0, 0)")
        ->type_name("X,Y,Z|camera")
        ->group(seen);
    app.add_option("--shade", texts.shade,
                   "path: lit; albedo: colours; normal; motion: the classes; cost: work of each pixel")
        ->type_name("path|albedo|normal|motion|cost")
        ->group(seen);
    app.add_option("--sky", texts.sky,
                   "What lights the scene from all around: a computed sky (unless told, where the scene has no lights), a "
                   "plain one (where it has), one colour, or a picture of all directions (.hdr, .exr)")
        ->type_name("physical|plain|R,G,B|FILE")
        ->group(seen);
    app.add_option("--sun", texts.sun,
                   "Where the sun of the physical sky stands: degrees up, and round from -Z to +X (48,138)")
        ->type_name("UP,ROUND")
        ->group(seen);
    app.add_option("--size", texts.size, "Of the picture (640x360) or the window (1280x720)")->type_name("WxH")->group(seen);
    app.add_option(
           "--spp", options.spp,
           "Samples a pixel (8, or with --noise 1024 at most; in the window, when to stop refining); 1: through pixel "
           "centres")
        ->type_name("N")
        ->group(seen);

    app.add_option("--exposure", texts.exposure_stops, "Brighter by so many stops, each twice the light; darker below 0")
        ->type_name("STOPS")
        ->capture_default_str()
        ->group(seen);
    app.add_option("--tone", texts.tone,
                   "How bright light fits a screen: true colours, a film's curve, or cut off (neutral, unless told)")
        ->type_name("neutral|aces|linear")
        ->group(seen);

    const char* const pictures = "Pictures instead of a window (each of these implies --headless)";
    app.add_option(
           "--shutter", options.shutter,
           "Motion blur: the share of a frame's time, 0 to 1, that the shutter is open, from the frame's time on (what "
           "the file's camera says, or 0)")
        ->type_name("SHARE")
        ->group(pictures);
    app.add_option("--slices", options.slices, "Times while it is open at which the scene is made: 1, 2, 4, ... 1024")
        ->type_name("N")
        ->capture_default_str()
        ->group(pictures);
    app.add_flag("--headless", options.is_headless, "Write pictures, a contact sheet, and a film where ffmpeg is installed")
        ->group(pictures);
    app.add_option(
           "--noise", options.noise,
           "Give each pixel samples until its standard error is this share of its brightness, such as 0.01; --spp is "
           "the most (1024, unless told)")
        ->type_name("SHARE")
        ->group(pictures);
    app.add_option("--time-limit", options.time_limit_s,
                   "End a frame's samples after so many seconds: the one thing that makes pictures depend on the machine")
        ->type_name("SECONDS")
        ->group(pictures);
    app.add_option("--frames", texts.frames, "From frame A to B, both included, or one frame (0-47)")
        ->type_name("A-B")
        ->group(pictures);
    app.add_option("--shard", texts.shard,
                   "The K-th of N shares of the frames, for as many machines; the last step is --resume")
        ->type_name("K/N")
        ->group(pictures);
    app.add_option("--out", texts.out, "Pictures' names, .png or .exr (out/frame_%04d.png)")
        ->type_name("PATTERN")
        ->group(pictures);
    app.add_flag("--denoise", options.is_denoised,
                 "Smooth each frame by its neighbours and the frames before, as the window does while it plays; 1 sample "
                 "unless told")
        ->group(pictures);
    app.add_flag("--resume", options.is_resumed, "Skip pictures that are there already (empty files do not count)")
        ->group(pictures);
    app.add_option("--stats", options.stats, "Times and counts of every frame, as JSON")->type_name("FILE")->group(pictures);
    app.add_option("--trace", options.trace, "Chrome trace events of every stage (chrome://tracing)")
        ->type_name("FILE")
        ->group(pictures);

    const char* const rest = "Rest";
    app.add_option("--threads", options.threads, "Threads to use; 0: all")
        ->type_name("N")
        ->capture_default_str()
        ->group(rest);
    app.add_option("--cache", texts.cache,
                   "Keep trees that take long to build in this folder, up to 1 GiB ($XDG_CACHE_HOME/zoetrope, or "
                   "~/.cache/zoetrope)")
        ->type_name("DIR")
        ->group(rest);
    app.add_option("--build-budget", options.build_budget_s,
                   "What building the trees of static and rigid nodes may take, as predicted from their triangles' number: "
                   "less time, slower rays")
        ->type_name("SECONDS")
        ->capture_default_str()
        ->group(rest);
    app.add_flag("--no-cache", flags.has_no_cache, "Neither keep trees nor read those that were kept")->group(rest);
    app.add_option("--screenshot", options.screenshot, "Save the window as a PNG file, then close it ...")
        ->type_name("FILE")
        ->group(rest);
    app.add_option("--after", options.screenshot_after_s, "... after this many seconds")
        ->type_name("SECONDS")
        ->capture_default_str()
        ->group(rest);
    app.set_help_flag("-h,--help", "This text")->group(rest);
}

void require(bool holds, const std::string& message) {
    if (!holds) throw UsageError(message);
}

void check_view(const CLI::App& app, Options& options, const Texts& texts) {
    if (app.count("--eye")) options.eye = parse_point(texts.eye, "--eye");
    if (app.count("--target")) options.target = parse_point(texts.target, "--target");
    options.begins_at_eye = texts.origin == "camera";
    if (app.count("--origin") && !options.begins_at_eye) options.origin = parse_point(texts.origin, "--origin");
    require(app.count("--eye") == app.count("--target"), "--eye and --target go together");
    require(!options.eye || !options.camera, "--eye and --camera: give one of them");
    require(!options.eye || *options.eye != *options.target, "--eye and --target are the same point");
    require(!options.fov_degrees || options.eye.has_value(), "--fov goes with --eye and --target");
    require(!options.fov_degrees || (*options.fov_degrees > 0.0f && *options.fov_degrees < 180.0f),
            "--fov: an angle between 0 and 180 degrees");
}

void check_sky(const CLI::App& app, Options& options, const Texts& texts) {
    if (app.count("--sky")) {
        const std::optional<std::vector<double>> color = parse_numbers(texts.sky, 3);
        options.sky = texts.sky == "physical" ? Sky::kPhysical
                      : texts.sky == "plain"  ? Sky::kPlain
                      : color                 ? Sky::kColor
                                              : Sky::kFile;
        options.sky_file = texts.sky;
        if (color) {
            options.sky_color = {(*color)[0], (*color)[1], (*color)[2]};
            for (const double c : *color)
                require(c >= 0.0 && c <= 1e6, fmt::format("--sky {}: light is a number from 0 to 1e6", texts.sky));
        }
    }
    if (app.count("--sun")) {
        const std::optional<std::vector<double>> angles = parse_numbers(texts.sun, 2);
        require(angles && std::abs((*angles)[0]) <= 90.0 && std::abs((*angles)[1]) <= 360.0,
                fmt::format("--sun {}: give UP,ROUND in degrees, -90 to 90 and -360 to 360, such as 30,120", texts.sun));
        require(!app.count("--sky") || options.sky == Sky::kPhysical, "--sun is the physical sky's: give --sky physical");
        options.sky = Sky::kPhysical;
        options.sun = {(*angles)[0], (*angles)[1]};
    }
}

void check_pictures(const CLI::App& app, Options& options, const Texts& texts) {
    if (app.count("--frames")) options.frames = parse_frames(texts.frames);
    if (app.count("--shard")) options.shard = parse_shard(texts.shard);
    if (app.count("--out")) options.out = NumberedPath(texts.out);
    const std::string extension = options.out.extension();
    require(extension == ".png" || extension == ".exr", fmt::format("--out {}: the name ends in .png or .exr", texts.out));
    require(options.frames.count() == 1 || options.out.has_number(),
            fmt::format("--out {}: several frames need a number in the name, such as frame_%04d.png", texts.out));
    require(!options.shutter || (*options.shutter >= 0.0 && *options.shutter <= 1.0), "--shutter: a number from 0 to 1");
    require(std::has_single_bit(options.slices) && options.slices <= 1024, "--slices: one of 1, 2, 4, ... 1024");
    require(!options.noise || (*options.noise > 0.0 && *options.noise <= 1.0), "--noise: a number above 0, up to 1");
    require(!options.time_limit_s || (*options.time_limit_s > 0.0 && *options.time_limit_s <= 1e6),
            "--time-limit: a number of seconds above 0, up to 1000000");
    for (const char* const name : {"--frames", "--shard", "--out", "--denoise", "--resume", "--stats", "--trace",
                                   "--shutter", "--slices", "--noise", "--time-limit"}) {
        if (app.count(name)) options.is_headless = true;
    }
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv) {
    CLI::App app("Plays an animated scene by tracing rays, in a window or into pictures.", kProgram);
    Options options;
    Texts texts;
    Flags flags;
    add_options(app, options, texts, flags);
    app.footer(footer());
    app.get_formatter()->column_width(38);
    if (!parse_command_line(app, argc, argv)) return std::nullopt;

    require(!flags.loops || !flags.stays, "--loop and --no-loop: give one of them");
    options.is_looping = !flags.stays;
    require(!flags.has_no_cache || !app.count("--cache"), "--cache and --no-cache: give one of them");
    if (app.count("--cache")) options.cache = texts.cache;
    if (flags.has_no_cache) options.cache.clear();
    if (app.count("--size")) options.size = parse_size(texts.size);
    if (app.count("--shade")) {
        const std::optional<Shade> shade = shade_from_name(texts.shade);
        require(shade.has_value(), fmt::format("--shade {}: one of path, albedo, normal, motion, cost", texts.shade));
        options.shade = *shade;
    }
    if (app.count("--tone")) {
        const std::optional<Tone> tone = tone_from_name(texts.tone);
        require(tone.has_value(), fmt::format("--tone {}: one of neutral, aces, linear", texts.tone));
        options.grade.tone = *tone;
    }
    require(std::abs(texts.exposure_stops) <= 32.0, "--exposure: a number of stops from -32 to 32");  // NaN fails
    options.grade.exposure = static_cast<float>(std::exp2(texts.exposure_stops));
    require(options.build_budget_s >= 0.0 && options.build_budget_s <= 86400.0,
            "--build-budget: a number of seconds from 0 to 86400");
    require(options.fps >= 0.001 && options.fps <= 100000.0, "--fps: a number from 0.001 to 100000");  // NaN fails
    require(!options.spp || (*options.spp >= 1 && *options.spp <= 65536), "--spp: a number from 1 to 65536");
    require(options.threads >= 0 && options.threads <= 1024, "--threads: a number from 0 (all) to 1024");
    require(options.screenshot_after_s >= 0.0 && options.screenshot_after_s <= 3600.0, "--after: a number from 0 to 3600");
    check_view(app, options, texts);
    check_sky(app, options, texts);
    check_pictures(app, options, texts);
    require(!options.is_denoised || options.shade == Shade::kPath,
            "--denoise is of the lit picture: it goes with --shade path");
    require(!options.is_denoised || (!options.is_resumed && options.shard.count == 1),
            "--denoise: frames depend on those before; it goes neither with --resume nor with --shard");
    require(!options.is_denoised || !(options.shutter || options.noise || options.time_limit_s),
            "--denoise is of moments and few samples: it goes with none of --shutter, --noise and --time-limit");
    require(!options.screenshot || !options.is_headless, "--screenshot is of the window; it does not go with --headless");
    return options;
}

}  // namespace zoe
