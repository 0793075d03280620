#pragma once

#include <cstddef>
#include <vector>

namespace zoe {

/// A stack with room for N entries in place, and as many more on the heap as a degenerate tree may need.
template <typename T, size_t N>
class SmallStack {
public:
    bool is_empty() const { return size_ == 0; }
    void push(const T& entry) {
        if (size_ < N) {
            in_place_[size_] = entry;
        } else {
            more_.push_back(entry);
        }
        ++size_;
    }
    T pop() {
        --size_;
        if (size_ < N) return in_place_[size_];
        const T top = more_.back();
        more_.pop_back();
        return top;
    }

private:
    size_t size_ = 0;
    T in_place_[N];
    std::vector<T> more_;
};

}  // namespace zoe
