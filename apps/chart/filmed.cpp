#include "apps/chart/filmed.h"

#include "apps/common/choose_view.h"

namespace zoe::chart {

Filmed::Filmed(int width, int height)
    : width(width),
      height(height),
      take{.scene = content.scene,
           .advance = [this](double time_s, FrameStats* stats) -> const Tlas& {
               return zoe::advance(content, time_s, stats);
           },
           .view =
               [this, aspect = float(width) / float(height)] {
                   return ViewChoice{.camera = camera_nodes(content.scene).front()}.view(content.scene, aspect);
               }} {}

}  // namespace zoe::chart
