#include "apps/chart/style.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace zoe::chart {
namespace {

// Okabe and Ito's colours, which stay apart in all common kinds of colour blindness.
constexpr unsigned kBlack = 0x000000, kGrey = 0x7a7a7a, kOrange = 0xe69f00, kSkyBlue = 0x56b4e9, kGreen = 0x009e73,
                   kBlue = 0x0072b2, kVermilion = 0xd55e00, kPurple = 0xcc79a7;

enum Shape {
    kPlus = 1,
    kCross,
    kStar,
    kOpenSquare,
    kSquare,
    kOpenCircle,
    kCircle,
    kOpenTriangle,
    kTriangle,
    kOpenDownward,
    kDownward,
    kOpenDiamond,
    kDiamond,
    kOpenPentagon,
    kPentagon
};

constexpr std::array kStyles = {
    // Builders.
    Style{"median split", kBlack, kCross, true},
    Style{"binned", kOrange, kSquare, true},
    Style{"sweep", kSkyBlue, kTriangle, true},
    Style{"reinserted", kGreen, kCircle, true},
    Style{"SBVH", kPurple, kDiamond, true},
    // Their settings.
    Style{"rounds", kBlue, kCircle, true},
    Style{"share of nodes", kOrange, kOpenSquare, true},
    Style{"visits a search", kGreen, kTriangle, true},
    Style{"least gain", kPurple, kDiamond, true},
    Style{"references", kVermilion, kDownward, true},
    Style{"overlap", kSkyBlue, kOpenCircle, true},
    Style{"spatial bins", kBlack, kOpenTriangle, true},
    Style{"leaf size", kGrey, kSquare, true},
    Style{"node cost", kBlack, kCross, true},
    Style{"leaf blocks", kVermilion, kPentagon, true},
    Style{"block cost", kSkyBlue, kSquare, true},
    // Clustering.
    Style{"exact", kBlue, kPentagon, true},
    Style{"fast (radius 2)", kVermilion, kOpenTriangle, true},
    Style{"fast (radius 8)", kVermilion, kDownward, true},
    Style{"fast (radius 32)", kVermilion, kOpenDownward, true},
    Style{"fast (top of 1)", kSkyBlue, kOpenTriangle, true},
    Style{"fast (top of 2048)", kSkyBlue, kOpenDownward, true},
    Style{"build_tlas, whole", kBlack, kOpenCircle, true},
    // How instances stand in the top level.
    Style{"turned boxes", kBlack, kOpenSquare, true},
    Style{"tight boxes", kBlue, kTriangle, true},
    Style{"turned boxes, opened", kOrange, kSquare, true},
    Style{"tight boxes, opened", kGreen, kCircle, true},
    // Triangle tests.
    Style{"ours", kGreen, kCircle, false},
    Style{"Moeller-Trumbore", kOrange, kSquare, false},
    Style{"Woop, in float", kSkyBlue, kTriangle, false},
    // Where vertices are placed.
    Style{"instanced", kBlue, kCircle, true},
    Style{"instanced, turned", kBlue, kOpenCircle, true},
    Style{"re-based, turned", kGreen, kTriangle, true},
    Style{"baked", kOrange, kSquare, true},
    // Skins.
    Style{"linear blend", kOrange, kSquare, true},
    Style{"dual quaternion", kBlue, kCircle, true},
    Style{"memcpy", kGrey, kCross, true},
    // Cages of subdivision surfaces.
    Style{"ring", kBlue, kCircle, true},
    Style{"ring, not at the limit", kBlue, kOpenCircle, true},
    Style{"figure", kOrange, kSquare, true},
    Style{"figure, not at the limit", kOrange, kOpenSquare, true},
    Style{"ball, Loop", kGreen, kTriangle, true},
    Style{"ball, Loop, not at the limit", kGreen, kOpenTriangle, true},
    // Motions.
    Style{"ripple", kBlue, kCircle, true},
    Style{"walk", kGreen, kTriangle, true},
    Style{"twist", kOrange, kSquare, true},
    Style{"explosion", kVermilion, kDiamond, true},
    Style{"ripple, rotated", kBlue, kOpenCircle, true},
    Style{"walk, rotated", kGreen, kOpenTriangle, true},
    Style{"twist, rotated", kOrange, kOpenSquare, true},
    Style{"explosion, rotated", kVermilion, kOpenDiamond, true},
    // Motion classes.
    Style{"static", kGreen, kCircle, true},
    Style{"deforming", kSkyBlue, kTriangle, true},
    Style{"arbitrary", kOrange, kSquare, true},
    // How often light bounces.
    Style{"no bounce", kBlack, kCross, true},
    Style{"1 bounce", kOrange, kSquare, true},
    Style{"2 bounces", kSkyBlue, kTriangle, true},
    Style{"4 bounces", kGreen, kCircle, true},
    Style{"8 bounces", kPurple, kDiamond, true},
    Style{"4 bounces, random", kGreen, kOpenCircle, true},
    // How light is looked for.
    Style{"both ways", kGreen, kCircle, true},
    Style{"rays towards lights", kOrange, kSquare, true},
    Style{"bounces alone", kPurple, kDiamond, true},
    // Which level of a texture is looked up.
    Style{"by ray cones", kGreen, kCircle, true},
    Style{"always the finest", kOrange, kSquare, true},
    // Times while the shutter is open.
    Style{"1 slice", kBlack, kCross, true},
    Style{"4 slices", kOrange, kSquare, true},
    Style{"16 slices", kGreen, kCircle, true},
    Style{"64 slices", kSkyBlue, kTriangle, true},
    // Who gets samples.
    Style{"all the same", kGrey, kCross, true},
    Style{"4 samples at least", kOrange, kSquare, true},
    Style{"16 samples at least", kGreen, kCircle, true},
    Style{"64 samples at least", kSkyBlue, kTriangle, true},
    // Pictures of few samples, smoothed.
    Style{"4 bounces, smoothed", kGreen, kTriangle, true},
    Style{"1 bounce, smoothed", kOrange, kOpenTriangle, true},
    Style{"2 bounces, smoothed", kSkyBlue, kOpenCircle, true},
    Style{"frames that a mean looks back on", kBlue, kSquare, true},
    Style{"rounds of the filter", kPurple, kOpenSquare, true},
    Style{"strength of the filter", kVermilion, kDiamond, true},
    // Light that is coarser than the picture.
    Style{"stretched", kGrey, kCross, true},
    Style{"on surfaces of a third", kOrange, kSquare, true},
    Style{"on surfaces of half", kGreen, kCircle, true},
    Style{"on full surfaces", kPurple, kDiamond, true},
    // When trees are rebuilt.
    Style{"always refitted", kSkyBlue, kOpenTriangle, true},
    Style{"always rebuilt", kOrange, kOpenSquare, true},
    Style{"by the sensor", kGreen, kCircle, true},
    Style{"in hindsight", kGrey, kOpenDiamond, true},
    Style{"as the engine counts", kBlack, kPlus, true},
    // Stages of a frame.
    Style{"ideal", kGrey, 0, true},
    Style{"animate", kSkyBlue, kOpenTriangle, true},
    Style{"deform", kPurple, kOpenSquare, true},
    Style{"update_blas", kOrange, kOpenDiamond, true},
    Style{"build_tlas", kVermilion, kDownward, true},
    Style{"trace", kBlack, kCircle, true},
    // Peers.
    Style{"Embree fast", kGrey, kPlus, true, true},
    Style{"Embree robust", kGrey, kStar, true, true},
    Style{"Embree, instances", kGrey, kStar, true, true},
    Style{"Embree, one scene", kGrey, kPlus, true, true},
    Style{"Embree LOW", kGrey, kPlus, true, true},
    Style{"Embree MEDIUM", kGrey, kStar, true, true},
    Style{"Embree HIGH", kGrey, kOpenDiamond, true, true},
};

}  // namespace

std::span<const Style> styles() {
    return kStyles;
}

const Style& style_of(const std::string& series) {
    const auto found = std::ranges::find_if(kStyles, [&](const Style& style) { return series == style.name; });
    if (found == kStyles.end()) throw std::logic_error("no style for the series '" + series + "'");
    return *found;
}

}  // namespace zoe::chart
