#include "apps/bench/options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/bench/bench_scenes.h"
#include "apps/common/parse_command_line.h"
#include "apps/common/usage_error.h"

namespace zoe {
namespace {

/// Options whose text is checked after all of them were read.
struct Texts {
    std::string size, peer, peer_quality = "medium";
};

std::string footer() {
    std::string text =
        "Every frame is made and traced; each stage's least time over the repeats counts, then median and 99th\n"
        "percentile over the frames. With --peer embree the same frames run through Embree, next to ours.\n\n"
        "Examples:\n"
        "  zoetrope-bench --list                            the scenes, explained\n"
        "  zoetrope-bench --peer embree                     all of them, beside Embree: under ten minutes on two cores\n"
        "  zoetrope-bench mixed --peer embree --peer-robust against Embree's watertight mode\n"
        "  zoetrope-bench --trees static --peer embree      each builder's trees, beside Embree's\n"
        "  zoetrope-bench fox.glb rigid-5000 --json x.json  a file, and a scene of the list at another size\n"
        "  zoetrope-bench 'fox.glb*200' --peer embree       200 of them, side by side, each at its own time of the clip\n"
        "  zoetrope-bench instances-300 --frames 3 --size 64x64 --write-hashes h.txt\n"
        "  zoetrope-bench --expect-hashes h.txt             the same frames: are the hits still the same?\n\n"
        "Exit codes: 0 done, 1 a scene, a file or a hash is at fault, 2 the command line is, 130 interrupted.";
    return text;
}

void add_options(CLI::App& app, Options& options, Texts& texts) {
    app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    app.add_option("SCENE", options.scenes,
                   "Scenes of --list (all, unless told), .glb or .gltf files, mesh sequences; SCENE*N: N copies of one")
        ->type_name("")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);

    const char* const what = "What is played";
    app.add_flag("--list", options.is_list, "Explain the scenes")->group(what);
    app.add_flag("--trees", options.compares_trees,
                 "Compare builders: all triangles of a scene's first frame as one mesh (static and deforming, unless told)")
        ->group(what);
    app.add_option("--frames", options.frames, "Frames measured, after one that warms up")->type_name("N")->group(what);
    app.add_option("--size", texts.size, "Primary rays")->type_name("WxH")->group(what);
    app.add_option("--repeats", options.repeats, "Times that each scene is played (its own number: see --list)")
        ->type_name("R")
        ->group(what);
    app.add_option("--threads", options.threads, "Threads to use (all)")->type_name("N")->group(what);
    app.add_flag("--exact", options.is_exact, "The top level clustered exactly (by the fast form, unless told)")
        ->group(what);

    const char* const peer = "Beside a peer";
    app.add_option("--peer", texts.peer, "The same frames through Embree, by its best configuration")
        ->type_name("embree")
        ->group(peer);
    app.add_flag("--peer-robust", options.peer.is_robust, "Embree's robust mode (fast, unless told)")->group(peer);
    app.add_option("--peer-quality", texts.peer_quality, "Of Embree's static trees; high: spatial splits")
        ->type_name("medium|high")
        ->capture_default_str()
        ->group(peer);
    app.add_flag("--peer-two-level", options.peer.is_two_level,
                 "Embree's instances under a top level (or all in one scene where that is faster, unless told)")
        ->group(peer);
    app.add_option("--disagreements", options.disagreements, "The first hundred rays of each scene that found other hits")
        ->type_name("FILE")
        ->group(peer);

    const char* const results = "Results";
    app.add_option("--json", options.json, "All numbers of all frames")->type_name("FILE")->group(results);
    app.add_option("--csv", options.csv, "The same as a table, a line a frame")->type_name("FILE")->group(results);
    app.add_option("--write-hashes", options.written_hashes, "Hashes of the hits, for --expect-hashes")
        ->type_name("FILE")
        ->group(results);
    app.add_option("--expect-hashes", options.expected_hashes, "Play the frames that FILE lists and compare their hits")
        ->type_name("FILE")
        ->group(results);
    app.set_help_flag("-h,--help", "This text")->group(results);
}

void require(bool holds, const std::string& message) {
    if (!holds) throw UsageError(message);
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv) {
    CLI::App app("Times each stage of a frame, with Embree beside it.", "zoetrope-bench");
    Options options;
    Texts texts;
    add_options(app, options, texts);
    app.footer(footer());
    app.get_formatter()->column_width(34);
    if (!parse_command_line(app, argc, argv)) return std::nullopt;
    require(!options.frames || (*options.frames >= 1 && *options.frames <= 100'000), "--frames: a number from 1 to 100000");
    require(!options.repeats || (*options.repeats >= 1 && *options.repeats <= 1000), "--repeats: a number from 1 to 1000");
    require(!app.count("--threads") || (options.threads >= 1 && options.threads <= 1024),
            "--threads: a number from 1 to 1024");
    if (app.count("--size")) options.size = parse_size(texts.size);
    require(!app.count("--peer") || texts.peer == "embree",
            fmt::format("--peer {}: embree is the one there is", texts.peer));
    options.has_peer = app.count("--peer") > 0;
    require(texts.peer_quality == "medium" || texts.peer_quality == "high",
            fmt::format("--peer-quality {}: medium or high", texts.peer_quality));
    options.peer.is_static_high = texts.peer_quality == "high";
    for (const char* const name : {"--peer-robust", "--peer-quality", "--peer-two-level", "--disagreements"})
        require(!app.count(name) || options.has_peer, fmt::format("{} goes with --peer embree", name));
    for (const char* const name : {"SCENE", "--frames", "--size", "--repeats", "--write-hashes"})
        require(!app.count(name) || !options.expected_hashes,
                fmt::format("{} does not go with --expect-hashes: its file says what is played", name));
    for (const char* const name : {"--frames", "--exact", "--csv", "--disagreements", "--write-hashes", "--expect-hashes",
                                   "--peer-quality", "--peer-two-level"})
        require(!app.count(name) || !options.compares_trees, fmt::format("{} does not go with --trees", name));
    return options;
}

}  // namespace zoe
