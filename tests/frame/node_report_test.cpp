// What is told of a node after a frame.

#include "engine/frame/node_report.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/classify.h"
#include "engine/frame/frame.h"

namespace zoe::test {
namespace {

void play(Content& content, double time_s) {
    if (content.write) content.write(content.scene, time_s);
    advance(content.scene, time_s);
}

/// The first node of a class that shows something, after two frames.
NodeReport report_of(Content& content, Motion motion, NodeId* node) {
    play(content, 0.0);
    play(content, 0.25);
    for (uint32_t k = 0; k < content.scene.nodes.size(); ++k) {
        const NodeReport report = report_node(content.scene, NodeId{k});
        if (!report.has_tree || report.motion != motion) continue;
        *node = NodeId{k};
        return report;
    }
    ADD_FAILURE() << "no node is " << name(motion);
    return {};
}

TEST(NodeReport, TellsWhatWasDoneByClass) {
    struct Case {
        const char* scene;
        int size;
        Motion motion;
        TreeAction action;
        bool is_shared;
        const char* method;
    };
    for (const Case& expected : {Case{"static", 1000, Motion::kStatic, TreeAction::kKept, true, "built once"},
                                 Case{"rigid", 3, Motion::kRigid, TreeAction::kKept, true, "built once"},
                                 Case{"deforming", 8, Motion::kDeforming, TreeAction::kRefitted, false, "refitted"},
                                 Case{"arbitrary", 200, Motion::kArbitrary, TreeAction::kRebuilt, false, "rebuilt"}}) {
        SCOPED_TRACE(expected.scene);
        Content content = make_content(expected.scene, expected.size);
        NodeId node;
        const NodeReport report = report_of(content, expected.motion, &node);
        EXPECT_EQ(report.content, expected.motion);
        EXPECT_EQ(report.action, expected.action) << name(report.action);
        EXPECT_EQ(report.is_shared, expected.is_shared);
        EXPECT_TRUE(std::string(report.method).starts_with(expected.method)) << report.method;
        EXPECT_GT(report.triangle_count, 0u);
        EXPECT_GT(report.vertex_count, 0u);
        EXPECT_GT(report.tree_cost, 1.0);
    }
}

TEST(NodeReport, FollowsAForcedClass) {
    Content content = make_content("rigid", 3);
    NodeId node;
    report_of(content, Motion::kRigid, &node);
    set_motion(content.scene, node, Motion::kArbitrary);
    play(content, 0.5);
    play(content, 0.75);
    const NodeReport report = report_node(content.scene, node);
    EXPECT_EQ(report.content, Motion::kRigid);
    EXPECT_EQ(report.motion, Motion::kArbitrary);
    EXPECT_FALSE(report.is_shared);
}

TEST(NodeReport, NeedsAFrameAndATree) {
    Content content = make_content("rigid", 3);
    EXPECT_THROW(report_node(content.scene, NodeId{0}), std::logic_error);
    Node empty;
    const NodeId node = content.scene.add(empty);
    play(content, 0.0);
    EXPECT_FALSE(report_node(content.scene, node).has_tree);
}

}  // namespace
}  // namespace zoe::test
