#pragma once

#include <atomic>
#include <cstdint>

namespace zoe {

/// Who is at a frame's trees: batches of rays on their way through them, or one who makes the next frame or drops them.
/// Nobody waits, so nobody can wait for himself: who comes second is refused. Any thread may call.
class TraceWatch {
public:
    /// Whether, just now, there are no rays and nobody holds the trees.
    bool is_idle() const { return users_.load(std::memory_order_acquire) == 0; }
    /// Refuses rays from here on.
    /// Throws     std::logic_error where rays are on their way, or the trees are held; nothing is changed then.
    void hold();
    /// Requires   that the trees are held.
    void let_go();

private:
    friend class RayBatch;
    void enter();
    void leave() { users_.fetch_sub(1, std::memory_order_release); }

    std::atomic<int64_t> users_{0};  ///< Batches; below 0: held.
};

/// A batch of rays that is on its way, for as long as this is there.
/// Cost       one atomic addition and one subtraction.
class RayBatch {
public:
    /// watch      null: nobody looks.
    /// Throws     std::logic_error where the trees are held.
    explicit RayBatch(TraceWatch* watch) : watch_(watch) {
        if (watch_) watch_->enter();
    }
    ~RayBatch() {
        if (watch_) watch_->leave();
    }
    RayBatch(const RayBatch&) = delete;
    RayBatch& operator=(const RayBatch&) = delete;

private:
    TraceWatch* watch_;
};

}  // namespace zoe
